/* Evaluation: distances of points to a set; the request is {"points", "path"?, "gradient"?} against
 * a field, and {"set", "points", "path"?} without one. The answer is a list of results, one a
 * point. */
#ifndef PROTO_EVALUATION_H
#define PROTO_EVALUATION_H

#include "gd/direction.h"
#include "gd/path.h"
#include "proto/http/options.h"
#include "proto/values/points.h"
#include "proto/values/set.h"

#define PROTO_EVALUATION_POINTS 100000 /* most points of a request */

/* All zero is an empty one. */
struct proto_evaluation {
    struct proto_points points;
    bool wants_path, wants_gradient;
};

/* invalid_request, too_large, insufficient_memory. Freed by proto_evaluation_free, and the set by
 * proto_set_free before the document is. */
bool proto_evaluation_decode(const json_t *document, struct proto_evaluation *out,
                             struct proto_problem *problem);
bool proto_evaluation_decode_with_set(const json_t *document, struct proto_set *set,
                                      struct proto_evaluation *out, struct proto_problem *problem);
void proto_evaluation_free(struct proto_evaluation *evaluation); /* a second time is harmless */

/* Fields of the answer, as bits of proto_options.fields: the answer's own one, which alone is all
 * of them, and those of each result. */
enum proto_result_field {
    PROTO_RESULT_FIELD_RESULTS = 1 << 0,
    PROTO_RESULT_FIELD_DISTANCE = 1 << 1,
    PROTO_RESULT_FIELD_REASON = 1 << 2,
    PROTO_RESULT_FIELD_NEAREST = 1 << 3,
    PROTO_RESULT_FIELD_PATH = 1 << 4,
    PROTO_RESULT_FIELD_GRADIENT = 1 << 5
};
extern const char *const proto_evaluation_fields[]; /* NULL-terminated, for proto_options_parse */
extern const char *const proto_distance_to_set_fields[];

/* The fields of each result that are wanted: those that were asked for in the query string, without
 * a path or a gradient unless the body asks for it. */
uint32_t proto_evaluation_wanted(const struct proto_evaluation *evaluation,
                                 const struct proto_options *options);

struct proto_result {
    double distance;            /* INFINITY: no path; NAN: beyond the distance that was asked for */
    uint32_t member;            /* the nearest, if there is a distance, */
    struct gd_point nearest;    /* and the point of it that is */
    const struct gd_path *path; /* NULL: there is none, or it is not wanted */
    bool has_gradient;
    struct gd_direction gradient;
};

/* The answer is begin, proto_result_encode for each point in turn, end. */
void proto_results_begin(struct proto_writer *writer);
void proto_results_end(struct proto_writer *writer);

/* Writes {"distance", "reason"?, "nearest", "path", "gradient"}, of these the wanted ones. Where
 * there is no distance all are null. */
void proto_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct proto_located_set *set, const struct proto_result *result,
                         uint32_t wanted, enum proto_geometry geometry);

/* Why there is no distance: no_path for INFINITY, beyond_max_distance for NAN. */
const char *proto_reason(double distance);

/* "distance" and, where there is none (INFINITY, NAN), "reason": no_path or beyond_max_distance. */
void proto_reason_encode(struct proto_writer *writer, double distance);

#endif
