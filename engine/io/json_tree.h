/* JSON tree: a whole document, for formats whose members come in any order (glTF).
 *
 * A value is known by its number in the order of the text; a member is two values, its key and what
 * it holds. A value takes 8 bytes and at least two bytes of the text, so the tree is at most four
 * times as large as the text. Strings stay as they are written. */
#ifndef GD_IO_JSON_TREE_H
#define GD_IO_JSON_TREE_H

#include "gd/control.h"
#include "io/scan.h"

#define GD__JSON_DEPTH   64   /* of containers in one another */
#define GD__JSON_MEMBERS 4096 /* of an object that gd__json_member looks at */

struct gd__json_value {
    uint32_t at;   /* where it begins, from the beginning of the text */
    uint32_t next; /* the value behind it and all that it holds */
};

struct gd__json {
    const char *text; /* borrowed */
    size_t size;
    struct gd__json_value *values; /* owned; the first is the document */
    uint32_t count;
};

/* The document that runs from the scan's cursor to its end. GD_SYNTAX, GD_TRUNCATED, GD_UNSUPPORTED
 * (deeper than GD__JSON_DEPTH), GD_TOO_LARGE (4 GiB of text), GD_NO_MEMORY, GD_CANCELLED,
 * GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__json_parse(const struct gd__scan *scan,
                                          const struct gd_control *control, struct gd__json *out);
void gd__json_free(struct gd__json *json);

static inline const char *gd__json_at(const struct gd__json *json, uint32_t value)
{
    return json->text + json->values[value].at;
}

static inline bool gd__json_is(const struct gd__json *json, uint32_t value, char begins)
{
    return *gd__json_at(json, value) == begins;
}

/* The items of an array: for (item = value + 1; item < gd__json_next(json, value); item =
 * gd__json_next(json, item)) */
static inline uint32_t gd__json_next(const struct gd__json *json, uint32_t value)
{
    return json->values[value].next;
}

/* What an object holds by that name, the first of several. UINT32_MAX: nothing, or it is no
 * object. */
uint32_t gd__json_member(const struct gd__json *json, uint32_t object, const char *name);

/* Whether it is a string of that text. */
bool gd__json_says(const struct gd__json *json, uint32_t value, const char *text);

/* The number, false: it is none. */
bool gd__json_real(const struct gd__json *json, uint32_t value, double *out);

#endif
