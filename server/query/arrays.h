/* Arrays: the numbers of an answer or of a request as bytes instead of JSON.
 *
 * DESIGN. A kind of query lists its arrays once (server_query_kind.list_arrays). The arrays are
 * written piece by piece without a copy, so an answer of any size can be streamed
 * (answer_stream.h). There are three forms: the container, with numbers as float64 or float32; the
 * first array as .npy; all arrays as .npz. The container, version 1, is little-endian:
 *
 *     0   "GDARRAYS"
 *     8   uint32 version, 1; uint32 count
 *     16  count entries of 64 bytes: name (32 bytes, the rest zeros), uint32 type (1 float64,
 *         2 float32, 3 uint32), uint32 columns (0: one number a row, and one dimension),
 *         uint64 rows, uint64 offset, uint64 bytes
 *         the arrays by row, each at an offset that is a multiple of 8
 *
 * Numbers that JSON writes as null are NaN, indices UINT32_MAX. See doc/020. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/path.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

#define SERVER_ARRAYS_MOST  8  /* arrays of one answer or request */
#define SERVER_ARRAYS_NAME  31 /* characters */
#define SERVER_ARRAYS_MEDIA "application/octet-stream"

enum server_array_type { SERVER_ARRAY_NUMBERS = 1, SERVER_ARRAY_FLOATS, SERVER_ARRAY_INDICES };

struct server_array {
    const char *name;
    enum server_array_type type; /* an array to be written has NUMBERS or INDICES */
    uint32_t columns;            /* 0 means that the array has one dimension */
    uint64_t rows;
    /* Copies rows as double or uint32_t. NULL means `source` is already an array of this type. */
    void (*read)(const void *source, uint64_t first, uint64_t count, void *out);
    const void *source; /* borrowed */
    /* if `read` is NULL: bytes from one row to the next; 0 means that the rows are contiguous */
    size_t stride;
};

struct server_arrays { /* all zero means empty */
    struct server_array list[SERVER_ARRAYS_MOST];
    uint32_t count;
};

/* Adds an array, of which only the struct is copied. */
void server_arrays_add(struct server_arrays *arrays, const struct server_array *array);

/* Like server_arrays_add, but the array is given as contiguous numbers or indices, which are
 * borrowed. */
void server_arrays_add_numbers(struct server_arrays *arrays, const char *name, uint32_t columns,
                               uint64_t rows, const double *numbers);
void server_arrays_add_indices(struct server_arrays *arrays, const char *name, uint32_t columns,
                               uint64_t rows, const uint32_t *indices);

/* Like server_arrays_add_numbers, but the numbers are a member of structs that are `stride` bytes
 * apart. */
void server_arrays_add_member(struct server_arrays *arrays, const char *name, uint64_t rows,
                              const double *first, size_t stride);

/* Copies all rows of the array to `out`. */
void server_array_copy(const struct server_array *array, void *out);

/* Writes the rows as JSON: an array of numbers, or of arrays of `columns` numbers. The array has at
 * most a few columns. */
void server_array_encode(const struct server_array *array, struct proto_writer *writer);

/* --- polylines -------------------------------------------------------------------------------- */

/* Points of several lines, one line after the other. */
struct server_lines {
    const struct gd_mesh *mesh;
    const struct gd_path *paths; /* the first line; the others follow, `stride` bytes apart */
    size_t stride;
    uint32_t count;
    uint32_t *first; /* count + 1 items: index among all points where each line begins */
};

/* Fills in `first`. Returns false if there are more points than an index can count. */
bool server_lines_count(struct server_lines *lines);

/* Adds the array "points" with x y z of each point, and the array "first" with the index of each
 * line's first point and, at the end, the total number of points. */
void server_arrays_add_lines(struct server_arrays *arrays, const struct server_lines *lines);
void server_arrays_add_named_lines(struct server_arrays *arrays, const struct server_lines *lines,
                                   const char *points, const char *first);

/* --- an answer -------------------------------------------------------------------------------- */

enum server_arrays_form {
    SERVER_ARRAYS_NONE,
    SERVER_ARRAYS_RAW, /* the first array as float64, without a head */
    SERVER_ARRAYS_F64,
    SERVER_ARRAYS_F32,
    SERVER_ARRAYS_NPY,
    SERVER_ARRAYS_NPZ
};

/* Writes the arrays, at least one. Equal arrays give equal bytes. */
void server_arrays_write(const struct server_arrays *arrays, enum server_arrays_form form,
                         struct proto_writer *writer);

/* --- a request -------------------------------------------------------------------------------- */

/* Reads the container, which may have arrays of all three types. The arrays are borrowed from
 * `bytes`, which must be aligned for doubles. Names must be among `known` (NULL-terminated,
 * static). On failure, returns false with invalid_request. */
bool server_arrays_read(const void *bytes, size_t size, const char *const *known,
                        struct server_arrays *out, struct proto_problem *problem);

/* Returns the array of that name, or NULL. */
const struct server_array *server_arrays_find(const struct server_arrays *arrays, const char *name);

/* Return one number or index. Numbers may be doubles or floats. */
double server_array_number(const struct server_array *array, uint64_t index);
uint32_t server_array_index(const struct server_array *array, uint64_t index);
