/* JSON tree: a parsed document, for formats whose members come in any order (glTF).
 *
 * Values are numbered in the order of the text. A member consists of two values: its key and its
 * value. Each value takes 8 bytes of the tree and at least two bytes of the text, so the tree is at
 * most four times as large as the text. Strings remain escaped. */
#pragma once

#include "gd/control.h"
#include "io/scan.h"

#define GD__JSON_DEPTH   64   /* largest depth of nested containers */
#define GD__JSON_MEMBERS 4096 /* gd__json_member searches at most this many members of an object */

struct gd__json_value {
    uint32_t at;   /* offset of the value in the text */
    uint32_t next; /* number of the value after this one and its contents */
};

struct gd__json {
    const char *text; /* borrowed */
    size_t size;
    struct gd__json_value *values; /* owned; the first value is the document */
    uint32_t count;
};

/* Parses the document that runs from the scan's cursor to its end. Errors: GD_SYNTAX, GD_TRUNCATED,
 * GD_UNSUPPORTED (deeper than GD__JSON_DEPTH), GD_TOO_LARGE (4 GiB of text), GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. */
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

/* Returns the value after this one. Iterates over an array: for (item = value + 1; item <
 * gd__json_next(json, value); item = gd__json_next(json, item)) */
static inline uint32_t gd__json_next(const struct gd__json *json, uint32_t value)
{
    return json->values[value].next;
}

/* Returns the value of the object's first member with that name. Returns UINT32_MAX if there is no
 * such member, or if `object` is not an object. */
uint32_t gd__json_member(const struct gd__json *json, uint32_t object, const char *name);

/* Returns true if the value is a string of that text. */
bool gd__json_says(const struct gd__json *json, uint32_t value, const char *text);

/* Reads the value as a number. Returns false if it is not a number. */
bool gd__json_real(const struct gd__json *json, uint32_t value, double *out);
