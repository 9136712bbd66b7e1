/* Matrix: the distances from each of some points to each of others. */
#ifndef PROTO_MATRIX_H
#define PROTO_MATRIX_H

#include "generated/requests.h"
#include "proto/http/options.h"

#define PROTO_MATRIX_ENTRIES 4000000 /* most distances: sources x targets */

/* There are at most PROTO_MATRIX_ENTRIES distances, else too_large with the limit. */
bool proto_matrix_check(const struct proto_matrix_request *request, struct proto_problem *problem);

/* Distances by row, a source each. INFINITY: no path; NAN: beyond max_distance. */
struct proto_matrix_answer {
    const double *distances; /* rows x columns */
    uint32_t rows, columns;
};

/* Writes {"distances", "reasons"?}, of these the fields that were asked for: rows of numbers and
 * nulls, and rows of nulls and reasons, which stand there only when a distance is null: no_path or
 * beyond_max_distance. */
void proto_matrix_encode(struct proto_writer *writer, const struct proto_matrix_answer *answer,
                         const struct proto_options *options);

/* Writes the distances as little-endian float64 by row, NaN where one is null, to `out`, if that is
 * not NULL; returns the bytes: 8 x rows x columns. */
size_t proto_matrix_bytes(const struct proto_matrix_answer *answer, void *out);

#endif
