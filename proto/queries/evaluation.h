/* Evaluation: distances of points to a set. The answer is a list of results, one for each point. */
#pragma once

#include "gd/direction.h"
#include "gd/path.h"
#include "proto/http/options.h"
#include "proto/values/set.h"

/* Returns the selected fields of each result: those of the query string, without path and gradient
 * unless the body requests them. */
uint32_t proto_evaluation_wanted(const struct proto_options *options, bool wants_path,
                                 bool wants_gradient);

struct proto_result {
    double distance;            /* INFINITY means no path; NAN means beyond max_distance */
    uint32_t member;            /* the nearest member; set only if there is a distance */
    struct gd_point nearest;    /* the nearest point of that member; set with `member` */
    const struct gd_path *path; /* NULL means that there is no path, or it is not selected */
    bool has_gradient;
    struct gd_direction gradient;
};

/* Writes a result. If there is no distance, all members are null. */
void proto_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct proto_located_set *set, const struct proto_result *result,
                         uint32_t wanted, enum proto_geometry geometry);

/* Returns the reason why there is no distance: no_path for INFINITY, beyond_max_distance for
 * NAN. */
const char *proto_reason(double distance);

/* Writes the member "reason" if there is no distance. */
void proto_reason_encode(struct proto_writer *writer, double distance);

/* Writes "distance" if has_distance is not 0, and the reason if either flag is not 0. */
void proto_distance_encode(struct proto_writer *writer, double distance, uint32_t has_distance,
                           uint32_t has_reason);
