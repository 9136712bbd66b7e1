/* Evaluation: distances of points to a set. The answer is a list of results, one a point. */
#ifndef PROTO_EVALUATION_H
#define PROTO_EVALUATION_H

#include "gd/direction.h"
#include "gd/path.h"
#include "proto/http/options.h"
#include "proto/values/set.h"

/* The fields of each result that are wanted: those that were asked for in the query string, without
 * a path or a gradient unless the body asks for it. */
uint32_t proto_evaluation_wanted(const struct proto_options *options, bool wants_path,
                                 bool wants_gradient);

struct proto_result {
    double distance;            /* INFINITY: no path; NAN: beyond the distance that was asked for */
    uint32_t member;            /* the nearest, if there is a distance, */
    struct gd_point nearest;    /* and the point of it that is */
    const struct gd_path *path; /* NULL: there is none, or it is not wanted */
    bool has_gradient;
    struct gd_direction gradient;
};

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
