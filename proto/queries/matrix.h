/* Matrix: the distances from each source to each target. */
#pragma once

#include "generated/requests.h"
#include "proto/http/options.h"

#define PROTO_MATRIX_ENTRIES 4000000 /* limit on distances, that is, sources x targets */

/* Checks that there are at most PROTO_MATRIX_ENTRIES distances. Otherwise fails with too_large and
 * the limit. */
bool proto_matrix_check(const struct proto_matrix_request *request, struct proto_problem *problem);

/* Distances, one row for each source. INFINITY means no path; NAN means beyond max_distance. */
struct proto_matrix_answer {
    const double *distances; /* rows x columns */
    uint32_t rows, columns;
};

/* Writes the answer, with "reasons" only if a distance is null. */
void proto_matrix_encode(struct proto_writer *writer, const struct proto_matrix_answer *answer,
                         const struct proto_options *options);
