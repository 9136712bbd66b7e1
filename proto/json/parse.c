/* Parses JSON by jansson, whose parser does not check whether its buffer could grow: without memory
 * it loses characters silently or fails an assertion. Therefore, in this file, the first failed
 * allocation leaves the parser by longjmp, and the parser's blocks are freed. */
#include "proto/json/decode.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A block allocated by jansson. The list has the blocks that this thread's running parser has
 * allocated and not freed. */
struct block {
    /* NULL means the first block. Blocks outside the list use neither of the two pointers */
    _Alignas(max_align_t) struct block *previous;
    struct block *next;
};

static _Thread_local struct {
    bool is_on;
    struct block *first;
    jmp_buf escape; /* leaves the parser */
} parser;

static void *take(size_t size)
{
    struct block *block = size <= SIZE_MAX - sizeof *block ? malloc(sizeof *block + size) : NULL;
    if (!parser.is_on) return block ? block + 1 : NULL;
    if (!block) longjmp(parser.escape, 1);
    *block = (struct block){.next = parser.first};
    if (block->next) block->next->previous = block;
    parser.first = block;
    return block + 1;
}

/* Frees a block. A running parser frees only its own blocks. */
static void give_back(void *bytes)
{
    if (!bytes) return;
    struct block *block = (struct block *)bytes - 1;
    if (parser.is_on) {
        if (block->next) block->next->previous = block->previous;
        *(block->previous ? &block->previous->next : &parser.first) = block->next;
    }
    free(block);
}

/* Runs before jansson allocates. */
__attribute__((constructor)) static void register_memory(void)
{
    json_set_alloc_funcs(take, give_back);
}

static void give_all_back(void)
{
    for (struct block *block = parser.first, *next; block; block = next) {
        next = block->next;
        free(block);
    }
}

/* --- the text, piece by piece ----------------------------------------------------------------- */

#define LOOK_BYTES 65536 /* bytes between two checks of the control */

struct source {
    const char *text;
    size_t size, at, looked_at;
    bool in_string, is_escaped;
    long depth;
    const struct gd_control *control;
    struct proto_parse_end *end;
};

/* Returns the offset of the first bracket in the next piece that nests too deeply. If there is
 * none, returns the offset of the piece's end. The parser checks that brackets match. */
static size_t first_too_deep(struct source *source, size_t end)
{
    size_t i = source->at;
    for (; i < end; i++) {
        char character = source->text[i];
        if (source->is_escaped) {
            source->is_escaped = false;
        } else if (source->in_string) {
            source->is_escaped = character == '\\';
            source->in_string = character != '"';
        } else if (character == '"') {
            source->in_string = true;
        } else if (character == '[' || character == '{') {
            if (++source->depth > PROTO_DECODE_DEPTH) return i;
        } else if (character == ']' || character == '}') {
            source->depth--;
        }
    }
    return i;
}

/* A json_load_callback_t. Returns 0 at the end, or (size_t)-1 to stop the parser. */
static size_t give_piece(void *buffer, size_t room, void *user)
{
    struct source *source = user;
    size_t left = source->size - source->at, size = left < room ? left : room;
    if (source->at >= source->looked_at) {
        source->looked_at = source->at + LOOK_BYTES;
        source->end->status = gd_control_check(source->control, 0);
    }
    size_t fine = first_too_deep(source, source->at + size);
    if (fine < source->at + size) source->end->deep_at = fine + 1;
    if (source->end->status || source->end->deep_at) return (size_t)-1;
    memcpy(buffer, source->text + source->at, size);
    source->at += size;
    return size;
}

json_t *proto_parse(const char *text, size_t size, const struct gd_control *control,
                    struct proto_parse_end *end)
{
    json_t *volatile document = NULL;
    struct source source = {
        .text = text, .size = size, .looked_at = LOOK_BYTES, .control = control, .end = end};
    *end = (struct proto_parse_end){.status = GD_OK};
    parser.first = NULL;
    parser.is_on = true;
    if (setjmp(parser.escape) == 0)
        document = json_load_callback(
            give_piece, &source, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &end->error);
    else
        end->status = GD_NO_MEMORY;
    parser.is_on = false;
    if (end->status == GD_NO_MEMORY) give_all_back();
    return document;
}
