/* Decode: parses untrusted JSON into a checked document and gives typed access to its members.
 *
 * Each accessor returns true, or false with an invalid_request problem that points at the fault.
 * `place` is the JSON Pointer of the object that contains `member`; its text is built only for a
 * problem. All functions are thread-safe. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "gd/control.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

/* --- text to a document (parse.c) --- */

#define PROTO_DECODE_DEPTH 32 /* deepest nesting of arrays and objects */

/* The reason why parsing failed. */
struct proto_parse_end {
    /* GD_NO_MEMORY, GD_DEADLINE or GD_CANCELLED; GD_OK means that the text is invalid */
    enum gd_status status;
    size_t deep_at;     /* 1 + offset of the bracket that nests too deeply; 0 means none */
    json_error_t error; /* any other error */
};

/* Returns the document, which the caller owns, or NULL on failure. The document has no duplicate
 * members, and all its numbers are json_real. `control` may be NULL. */
json_t *proto_parse(const char *text, size_t size, const struct gd_control *control,
                    struct proto_parse_end *end);

/* --- checked documents --- */

/* Returns an upper bound of the memory of the document parsed from this text: up to a hundred times
 * the size of the text. O(size). Stops early if `control` (may be NULL) ends the work, because
 * parsing then stops, too. */
size_t proto_decode_cost(const void *bytes, size_t size, const struct gd_control *control);

/* Parses a body: UTF-8 JSON, at most PROTO_DECODE_DEPTH levels deep, without duplicate members,
 * without NUL, and without numbers beyond the range of doubles. All numbers become json_real.
 * `bytes` are borrowed for the call. The caller owns the document (json_decref). On failure returns
 * NULL, and the problem names line (if there are several), column and byte. Memory: about 60 bytes
 * a number. */
json_t *proto_decode_document(const void *bytes, size_t size, struct proto_problem *problem);

/* Like proto_decode_document, but with a deadline and cancellation. */
json_t *proto_decode_document_within(const void *bytes, size_t size,
                                     const struct gd_control *control,
                                     struct proto_problem *problem);

/* Writes the JSON Pointer of a member, or of an array's item, of the value at `place`. Truncates it
 * at the size of its buffer. */
#define PROTO_PLACE PROTO_PROBLEM_POINTER
void proto_place_of_member(char out[PROTO_PLACE], const char *place, const char *member);
void proto_place_of_element(char out[PROTO_PLACE], const char *place, size_t index);

/* Checks that `value` is an object without members other than `members` (NULL-terminated). */
bool proto_decode_object(const json_t *value, const char *place, const char *const *members,
                         struct proto_problem *problem);

/* Returns the required member, borrowed from its object; NULL with the problem if it is missing. */
const json_t *proto_decode_member(const json_t *object, const char *place, const char *member,
                                  struct proto_problem *problem);

/* Read a required number, or a required index (an integer from 0 to 2^32 - 2). */
bool proto_decode_number(const json_t *object, const char *place, const char *member, double *out,
                         struct proto_problem *problem);
bool proto_decode_index(const json_t *object, const char *place, const char *member, uint32_t *out,
                        struct proto_problem *problem);

/* Reads an optional boolean, by default false. */
bool proto_decode_flag(const json_t *object, const char *place, const char *member, bool *out,
                       struct proto_problem *problem);

/* Reads a required array of exactly `count` numbers or indices. */
bool proto_decode_numbers(const json_t *object, const char *place, const char *member, size_t count,
                          double *out, struct proto_problem *problem);
bool proto_decode_indices(const json_t *object, const char *place, const char *member, size_t count,
                          uint32_t *out, struct proto_problem *problem);

/* Writes a document in the writer's form: numbers have their shortest form. */
void proto_write_document(struct proto_writer *writer, const json_t *value);

/* Reads an array of exactly `count` numbers. Returns false, without a problem, if it is not such an
 * array. */
bool proto_read_numbers(const json_t *array, size_t count, double *out);
