/* Vector: tangent vectors in requests and answers, and the operations exp, log and transport.
 *
 *     exp        {"start", "vectors", "combine"?}       -> {"start", "vectors", "points", "paths"}
 *     log        {"from", "to", "first_vector_only"?}   -> {"from", "vectors"}
 *     transport  {"from", "to", "vectors", "combine"?}  -> {"from", "to", "distance", "reason"?,
 *                                                           "vectors"}
 *
 * A vector is {"direction", "length"}, {"segments": [{"direction", "length"}…]}, or a vector as log
 * answers it, with all three, "cut_locus" and "reason". exp traces the segments where there are
 * any. transport and combine use direction and length where they are given. */
#ifndef PROTO_VECTOR_H
#define PROTO_VECTOR_H

#include "gd/vector.h"
#include "proto/http/options.h"
#include "proto/values/direction.h"
#include "proto/values/points.h"

/* most of a request, of log's targets too; and most segments of them all */
#define PROTO_VECTORS       10000
#define PROTO_VECTOR_LENGTH 1e150 /* as coordinates */

struct proto_segment {
    bool has_direction; /* false: the length is 0 */
    struct proto_direction direction;
    double length;
};

/* The vectors of a request: vector i has the segments first[i] to first[i + 1] - 1; none: no path
 * leads to where log was asked. All zero is an empty list. */
struct proto_vectors {
    struct proto_segment *segments;
    uint32_t *first; /* count + 1 */
    uint32_t count;
    double *factors; /* count of them: combine; NULL: there is none */
};

void proto_vectors_free(struct proto_vectors *vectors); /* leaves an empty list */

struct proto_exp {
    struct proto_point start;
    struct proto_vectors vectors;
};

struct proto_log {
    struct proto_point from;
    struct proto_points to; /* empty: to all vertices */
    bool first_vector_only;
};

struct proto_transport {
    struct proto_points ends; /* from, to */
    struct proto_vectors vectors;
};

/* invalid_request, too_large (with the limit), insufficient_memory. What was decoded is the
 * caller's to free: its vectors and points. */
bool proto_exp_decode(const json_t *document, struct proto_exp *out, struct proto_problem *problem);
bool proto_log_decode(const json_t *document, struct proto_log *out, struct proto_problem *problem);
bool proto_transport_decode(const json_t *document, struct proto_transport *out,
                            struct proto_problem *problem);

/* Is the value an object with no members but those of a vector that log answers? Checks only the
 * members that carry no geometry. invalid_request. */
bool proto_vector_check(const json_t *value, const char *place, struct proto_problem *problem);

/* Decodes "direction" and "length". A null direction is of a vector of length 0. Other members are
 * not looked at. invalid_request. */
bool proto_segment_decode(const json_t *value, const char *place, struct proto_segment *out,
                          struct proto_problem *problem);

/* Lays a vector of one segment on the surface at a point, as proto_direction_locate does; without a
 * direction, any of length 0. */
bool proto_segment_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                          const struct proto_segment *segment, struct gd_vector *out,
                          struct proto_problem *problem);

/* Writes {"direction", "length"}. A direction that does not exist (NULL: there is no path, or the
 * length is 0) is null; an infinite length is null with "reason": "no_path". */
void proto_vector_encode(struct proto_writer *writer, const struct gd_direction *direction,
                         double length);

/* The same, and the "segments" when there are more than one, and "cut_locus" where there are other
 * paths as short. */
void proto_log_encode(struct proto_writer *writer, const struct gd_log *log, bool is_cut);

#endif
