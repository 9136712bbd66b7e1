/* Matrix: the distances from each of some points to each of others. The request is {"sources",
 * "targets", "max_distance"?}. */
#ifndef PROTO_MATRIX_H
#define PROTO_MATRIX_H

#include "proto/http/options.h"
#include "proto/values/points.h"

#define PROTO_MATRIX_ENTRIES 4000000 /* most distances: sources x targets */

struct proto_matrix { /* all zero is an empty one */
    struct proto_points sources, targets;
    double max_distance; /* INFINITY: no limit */
};

/* Field of the answer, as bits of proto_options.fields. The reasons come where distances are null,
 * asked for or not. */
enum proto_matrix_field {
    PROTO_MATRIX_FIELD_DISTANCES = 1 << 0,
    PROTO_MATRIX_FIELD_REASONS = 1 << 1
};
extern const char *const proto_matrix_fields[]; /* NULL-terminated, for proto_options_parse */

/* Both lists have at least one point. invalid_request; too_large, with the limit, when there would
 * be more than PROTO_MATRIX_ENTRIES distances; insufficient_memory. Freed by proto_matrix_free. */
bool proto_matrix_decode(const json_t *document, struct proto_matrix *out,
                         struct proto_problem *problem);
void proto_matrix_free(struct proto_matrix *matrix); /* a second time is harmless */

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
