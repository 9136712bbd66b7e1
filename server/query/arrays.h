/* Arrays: the numbers of an answer, or of a request, as bytes instead of JSON.
 *
 * DESIGN. A kind of query lists its arrays once (server_query_kind.list_arrays); they are written
 * from where they lie, piece by piece, so an answer of any size streams (answer_stream.h). The forms
 * are the arrays container of float64 or float32 numbers, the first array as .npy, and all of them
 * as .npz. The container, version 1, is little-endian:
 *
 *     0   "GDARRAYS"
 *     8   uint32 version, 1; uint32 count
 *     16  count entries of 64 bytes: name (32 bytes, the rest zeros), uint32 type (1 float64,
 *         2 float32, 3 uint32), uint32 columns (0: one number a row, and one dimension),
 *         uint64 rows, uint64 offset, uint64 bytes
 *         the arrays by row, each at an offset that is a multiple of 8
 *
 * Numbers that JSON writes as null are NaN, indices UINT32_MAX. See doc/020. */
#ifndef SERVER_QUERY_ARRAYS_H
#define SERVER_QUERY_ARRAYS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/path.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

#define SERVER_ARRAYS_MOST  8  /* of one answer or request */
#define SERVER_ARRAYS_NAME  31 /* characters */
#define SERVER_ARRAYS_MEDIA "application/octet-stream"

enum server_array_type { SERVER_ARRAY_NUMBERS = 1, SERVER_ARRAY_FLOATS, SERVER_ARRAY_INDICES };

struct server_array {
    const char *name;
    enum server_array_type type; /* to be written: NUMBERS or INDICES */
    uint32_t columns;            /* 0: the array has one dimension */
    uint64_t rows;
    /* Copies rows as double or uint32_t; NULL: `source` has them so. */
    void (*read)(const void *source, uint64_t first, uint64_t count, void *out);
    const void *source; /* borrowed */
};

struct server_arrays { /* all zero is empty */
    struct server_array list[SERVER_ARRAYS_MOST];
    uint32_t count;
};

/* Adds an array whose rows lie one behind the other. */
void server_arrays_add(struct server_arrays *arrays, const struct server_array *array);

/* --- polylines -------------------------------------------------------------------------------- */

/* The points of some lines, one line after the other. */
struct server_lines {
    const struct gd_mesh *mesh;
    uint32_t count;
    /* Finds the points of a line. */
    const struct gd_point *(*points)(const void *user, uint32_t line, uint32_t *count);
    const void *user;
    uint32_t *first; /* count + 1 of them: where in all points each line begins */
};

/* Fills in `first`. False: there are more points than an index can tell. */
bool server_lines_count(struct server_lines *lines);

/* Adds "points", x y z of each, and "first", the lines' first points and the number of all. */
void server_arrays_add_lines(struct server_arrays *arrays, const struct server_lines *lines);

/* --- an answer -------------------------------------------------------------------------------- */

enum server_arrays_form {
    SERVER_ARRAYS_NONE,
    SERVER_ARRAYS_F64,
    SERVER_ARRAYS_F32,
    SERVER_ARRAYS_NPY,
    SERVER_ARRAYS_NPZ
};

/* The forms of an answer, behind others. */
#define SERVER_ARRAYS_FORMS                                                                        \
    {"f64", SERVER_ARRAYS_MEDIA, false}, {"f32", SERVER_ARRAYS_MEDIA, false},                      \
        {"npy", "application/x-npy", false},                                                       \
    {                                                                                              \
        "npz", "application/x-npz", false                                                          \
    }

/* The form of that name (`server_form.name`). */
enum server_arrays_form server_arrays_form(const char *name);

/* Writes the arrays, the same each time. There is at least one. */
void server_arrays_write(const struct server_arrays *arrays, enum server_arrays_form form,
                         struct proto_writer *writer);

/* --- a request -------------------------------------------------------------------------------- */

/* Reads the container: arrays of all three types, borrowed from `bytes`, which is aligned for
 * doubles. The names are those of `known` (NULL-terminated, static). False: invalid_request. */
bool server_arrays_read(const void *bytes, size_t size, const char *const *known,
                        struct server_arrays *out, struct proto_problem *problem);

/* The array of that name, or NULL. */
const struct server_array *server_arrays_find(const struct server_arrays *arrays, const char *name);

/* One number of it, of either type of numbers. */
double server_array_number(const struct server_array *array, uint64_t index);
uint32_t server_array_index(const struct server_array *array, uint64_t index);

#endif
