#include "proto/parse.h"

#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>

/* A block of jansson's; the listed ones are those that a parser which runs in this thread has taken and not given back. */
struct block {
    _Alignas(max_align_t) struct block *previous; /* NULL: the first; both unused when it is not listed */
    struct block *next;
};

static _Thread_local struct {
    bool is_on;
    struct block *first;
    jmp_buf escape; /* out of the parser */
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

/* While a parser runs, it gives back nothing but its own. */
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

/* Before jansson takes anything. */
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

json_t *proto_parse(const char *text, size_t size, json_error_t *error, bool *is_starved)
{
    json_t *volatile document = NULL;
    parser.first = NULL;
    parser.is_on = true;
    *is_starved = setjmp(parser.escape) != 0;
    if (!*is_starved) document = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, error);
    parser.is_on = false;
    if (*is_starved) give_all_back();
    return document;
}
