#include "io/json_tree.h"

#include <stdlib.h>
#include <string.h>

#include "gd/number.h"
#include "io/json_text.h"

#define LOOK_BYTES 65536 /* bytes of text between two checks of the control */

/* The parser runs twice. The first run counts the values. Then their memory is allocated, and the
 * second run stores them. */
struct parser {
    struct gd__scan scan;
    const char *text; /* beginning of the document */
    const struct gd_control *control;
    const char *next_look;
    struct gd__json_value *values; /* NULL means that values are only counted */
    uint32_t count;
    uint32_t open[GD__JSON_DEPTH]; /* the open containers around the cursor */
    char ends[GD__JSON_DEPTH];     /* the character that closes each of them */
    unsigned depth;
};

static enum gd_status look(struct parser *parser)
{
    if (parser->scan.at < parser->next_look) return GD_OK;
    size_t left = gd__scan_left(&parser->scan);
    parser->next_look = parser->scan.at + (left < LOOK_BYTES ? left : LOOK_BYTES);
    return gd_control_check(parser->control, 0);
}

static void begin_value(struct parser *parser)
{
    if (parser->values)
        parser->values[parser->count].at = (uint32_t)(parser->scan.at - parser->text);
    parser->count++;
}

/* Stores where a value ends. Called after the contents of the value have been read. */
static void end_value(struct parser *parser, uint32_t value)
{
    if (parser->values) parser->values[value].next = parser->count;
}

static enum gd_status read_string(struct parser *parser, const char *what)
{
    struct gd__scan *scan = &parser->scan;
    if (gd__scan_left(scan) == 0 || *scan->at != '"') return gd__scan_unexpected(scan, what);
    scan->at++;
    enum gd_status status = GD_OK;
    while (status == GD_OK && gd__scan_left(scan) > 0 && *scan->at != '"') {
        status = gd__json_string_run(scan, what, LOOK_BYTES);
        if (status == GD_OK) status = look(parser);
    }
    return status == GD_OK ? gd__json_expect(scan, '"') : status;
}

static enum gd_status read_word(struct parser *parser)
{
    static const char *const words[] = {"true", "false", "null"};
    struct gd__scan *scan = &parser->scan;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        size_t length = strlen(words[i]);
        if (gd__scan_left(scan) < length || memcmp(scan->at, words[i], length) != 0) continue;
        scan->at += length;
        return GD_OK;
    }
    double number;
    return gd__json_number(scan, &number);
}

static enum gd_status enter(struct parser *parser, char end)
{
    if (parser->depth == GD__JSON_DEPTH)
        return gd__scan_fail(&parser->scan, parser->scan.at, GD_UNSUPPORTED,
                             "the document is nested more than %d deep", GD__JSON_DEPTH);
    parser->open[parser->depth] = parser->count - 1;
    parser->ends[parser->depth++] = end;
    parser->scan.at++;
    return GD_OK;
}

/* Reads a number, string or word, or the beginning of an object or array. */
static enum gd_status read_value(struct parser *parser)
{
    struct gd__scan *scan = &parser->scan;
    gd__json_skip_space(scan);
    char c = gd__scan_left(scan) > 0 ? *scan->at : '\0';
    uint32_t value = parser->count;
    begin_value(parser);
    if (c == '{' || c == '[') return enter(parser, c == '{' ? '}' : ']');
    enum gd_status status = c == '"' ? read_string(parser, "a string") : read_word(parser);
    end_value(parser, value);
    return status;
}

static enum gd_status read_key(struct parser *parser)
{
    gd__json_skip_space(&parser->scan);
    uint32_t key = parser->count;
    begin_value(parser);
    enum gd_status status = read_string(parser, "a key");
    end_value(parser, key);
    return status == GD_OK ? gd__json_expect(&parser->scan, ':') : status;
}

/* Reads the text after a value: a comma, or the ends of containers. */
static enum gd_status leave(struct parser *parser)
{
    while (parser->depth > 0) {
        if (gd__json_accept(&parser->scan, ',')) return GD_OK;
        enum gd_status status = gd__json_expect(&parser->scan, parser->ends[parser->depth - 1]);
        if (status != GD_OK) return status;
        end_value(parser, parser->open[--parser->depth]);
    }
    return GD_OK;
}

/* Reads a member of an object, an item of an array, or the document itself. Then reads the ends of
 * the containers that end there. */
static enum gd_status read_item(struct parser *parser)
{
    bool in_object = parser->depth > 0 && parser->ends[parser->depth - 1] == '}';
    unsigned depth = parser->depth;
    enum gd_status status = look(parser);
    if (status == GD_OK && in_object) status = read_key(parser);
    if (status == GD_OK) status = read_value(parser);
    if (status != GD_OK) return status;
    if (parser->depth > depth) { /* the value is a container, which may be empty */
        if (!gd__json_accept(&parser->scan, parser->ends[depth])) return GD_OK;
        end_value(parser, parser->open[--parser->depth]);
    }
    return leave(parser);
}

static enum gd_status read_document(struct parser *parser)
{
    enum gd_status status;
    do status = read_item(parser);
    while (status == GD_OK && parser->depth > 0);
    if (status != GD_OK) return status;
    gd__json_skip_space(&parser->scan);
    return gd__scan_left(&parser->scan) == 0
               ? GD_OK
               : gd__scan_unexpected(&parser->scan, "the end of the document");
}

enum gd_status gd__json_parse(const struct gd__scan *scan, const struct gd_control *control,
                              struct gd__json *out)
{
    if (gd__scan_left(scan) >= UINT32_MAX)
        return gd__scan_fail(scan, scan->at, GD_TOO_LARGE,
                             "the document has 4 GiB of text or more");
    struct parser parser = {
        .scan = *scan, .text = scan->at, .control = control, .next_look = scan->at};
    struct parser again = parser;
    enum gd_status status = read_document(&parser);
    if (status != GD_OK) return status;
    again.values = malloc(parser.count * sizeof *again.values);
    if (!again.values) return gd_fail_status(scan->detail, GD_NO_MEMORY);
    status = read_document(&again);
    if (status == GD_OK)
        *out = (struct gd__json){.text = scan->at,
                                 .size = gd__scan_left(scan),
                                 .values = again.values,
                                 .count = again.count};
    else
        free(again.values);
    return status;
}

void gd__json_free(struct gd__json *json)
{
    free(json->values);
    *json = (struct gd__json){0};
}

bool gd__json_says(const struct gd__json *json, uint32_t value, const char *text)
{
    return gd__json_is(json, value, '"') && gd__json_string_is(gd__json_at(json, value), text);
}

uint32_t gd__json_member(const struct gd__json *json, uint32_t object, const char *name)
{
    if (!gd__json_is(json, object, '{')) return UINT32_MAX;
    uint32_t end = gd__json_next(json, object);
    unsigned seen = 0;
    for (uint32_t key = object + 1; key < end && seen < GD__JSON_MEMBERS;
         key = gd__json_next(json, key + 1), seen++) {
        if (gd__json_says(json, key, name)) return key + 1;
    }
    return UINT32_MAX;
}

bool gd__json_real(const struct gd__json *json, uint32_t value, double *out)
{
    const char *at = gd__json_at(json, value);
    if (*at != '-' && (*at < '0' || *at > '9')) return false;
    return gd_number_parse(at, json->text + json->size, out) != NULL;
}
