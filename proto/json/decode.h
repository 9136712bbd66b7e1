/* Decode: hostile JSON in, a checked document out, and typed access to its members.
 *
 * Each accessor returns true, or false with an invalid_request problem that points at the fault.
 * `place` is the JSON Pointer of the object that `member` is looked up in; text for it is made only
 * when something is wrong. All are thread-safe. */
#ifndef PROTO_DECODE_H
#define PROTO_DECODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "proto/json/parse.h"
#include "proto/json/problem.h"

#define PROTO_DECODE_DEPTH PROTO_PARSE_DEPTH

/* Upper bound of the memory that a document takes which is parsed from this text: up to a hundred
 * times its size. O(size). Stops early once `control` (NULL: none) ends the work: then parsing
 * ends, too. */
size_t proto_decode_cost(const void *bytes, size_t size, const struct gd_control *control);

/* Parses a body: UTF-8 JSON, at most PROTO_DECODE_DEPTH deep, no duplicate members, no NUL, no
 * number beyond the doubles. All numbers become json_real. `bytes` are borrowed for the call. The
 * caller owns the document (json_decref); NULL with a problem that names line (if there are
 * several), column and byte. Memory: about 60 bytes a number. */
json_t *proto_decode_document(const void *bytes, size_t size, struct proto_problem *problem);

/* The same, until a deadline or a cancel. */
json_t *proto_decode_document_within(const void *bytes, size_t size,
                                     const struct gd_control *control,
                                     struct proto_problem *problem);

/* The place of a member, or of an element, of what is at `place`: cut at the size of its buffer. */
#define PROTO_PLACE PROTO_PROBLEM_POINTER
void proto_place_of_member(char out[PROTO_PLACE], const char *place, const char *member);
void proto_place_of_element(char out[PROTO_PLACE], const char *place, size_t index);

/* `value` is an object and has no members but `members` (NULL-terminated). */
bool proto_decode_object(const json_t *value, const char *place, const char *const *members,
                         struct proto_problem *problem);

/* The member, borrowed from its object; it must be there: else NULL and the problem. */
const json_t *proto_decode_member(const json_t *object, const char *place, const char *member,
                                  struct proto_problem *problem);

/* The member must be there and be a number (an index: integral, 0 to 2^32 - 2). */
bool proto_decode_number(const json_t *object, const char *place, const char *member, double *out,
                         struct proto_problem *problem);
bool proto_decode_index(const json_t *object, const char *place, const char *member, uint32_t *out,
                        struct proto_problem *problem);

/* A member that may be left out, for false. */
bool proto_decode_flag(const json_t *object, const char *place, const char *member, bool *out,
                       struct proto_problem *problem);

/* A limit of distances, "max_distance" of a request's document: more than 0; 0 when it is left
 * out. */
bool proto_decode_max_distance(const json_t *document, double *out, struct proto_problem *problem);

/* The member must be there and be an array of exactly `count` of them. */
bool proto_decode_numbers(const json_t *object, const char *place, const char *member, size_t count,
                          double *out, struct proto_problem *problem);
bool proto_decode_indices(const json_t *object, const char *place, const char *member, size_t count,
                          uint32_t *out, struct proto_problem *problem);

#endif
