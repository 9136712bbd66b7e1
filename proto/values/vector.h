/* Vector: tangent vectors in requests and answers, and the requests of exp, log and transport. If a
 * vector has segments, `exp` traces them. `transport` and `combine` use the vector's own direction
 * and length. */
#pragma once

#include "gd/vector.h"
#include "proto/http/options.h"
#include "proto/values/direction.h"
#include "proto/values/points.h"

/* limit on the vectors of a request, on the targets of log, and on the total number of segments */
#define PROTO_VECTORS       10000
#define PROTO_VECTOR_LENGTH 1e150 /* the same limit as for coordinates */

struct proto_segment {
    bool has_direction; /* false if the length must be 0 */
    struct proto_direction direction;
    double length;
};

/* The vectors of a request. Vector i has the segments first[i] to first[i + 1] - 1; a vector
 * without segments is a result of log for a target to which no path leads. All zero is an empty
 * list. */
struct proto_vectors {
    struct proto_segment *segments;
    uint32_t *first; /* count + 1 */
    uint32_t count;
    double *factors; /* `count` factors for the operation combine; may be NULL */
};

void proto_vectors_free(struct proto_vectors *vectors); /* leaves an empty list */

struct proto_exp {
    struct proto_point start;
    struct proto_vectors vectors;
};

struct proto_log {
    struct proto_point from;
    struct proto_points to; /* the targets; empty means all vertices */
    bool first_vector_only;
};

struct proto_transport {
    struct proto_points ends; /* from, to */
    struct proto_vectors vectors;
};

/* Decode requests. Problems: invalid_request, too_large (with the limit), insufficient_memory. The
 * caller frees the decoded vectors and points. */
bool proto_exp_decode(const json_t *document, struct proto_exp *out, struct proto_problem *problem);
bool proto_log_decode(const json_t *document, struct proto_log *out, struct proto_problem *problem);
bool proto_transport_decode(const json_t *document, struct proto_transport *out,
                            struct proto_problem *problem);

/* Checks that the value is an object without members other than those of a vector in answers of
 * log. Checks the content only of members that carry no geometry. Problem: invalid_request. */
bool proto_vector_check(const json_t *value, const char *place, struct proto_problem *problem);

/* Decodes "direction" and "length". A null direction requires length 0. Ignores other members.
 * Problem: invalid_request. */
bool proto_segment_decode(const json_t *value, const char *place, struct proto_segment *out,
                          struct proto_problem *problem);

/* Computes a vector of one segment on the surface at a point, as proto_direction_locate does. A
 * vector without a direction, which has length 0, is accepted. */
bool proto_segment_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                          const struct proto_segment *segment, struct gd_vector *out,
                          struct proto_problem *problem);

/* Writes direction and length. A direction of NULL becomes null; an infinite length becomes null,
 * with the reason no_path. */
void proto_vector_encode(struct proto_writer *writer, const struct gd_direction *direction,
                         double length);

/* Writes direction and length, "segments" if there are several, and "cut_locus" if other paths are
 * equally short. */
void proto_log_encode(struct proto_writer *writer, const struct gd_log *log, bool is_cut);
