/* Spline: a geodesic Hermite spline in a request, by itself or as a curve, and in an answer.
 *
 * Decoding needs no mesh. Locating moves points and tangents onto a mesh. */
#pragma once

#include <jansson.h>

#include "gd/frame.h"
#include "gd/spline.h"
#include "generated/answers.h"
#include "proto/http/options.h"
#include "proto/values/points.h"
#include "proto/values/vector.h"

#define PROTO_SPLINE_PLACES 100000

/* All zero means no spline. */
struct proto_spline {
    char place[PROTO_KEPT_PLACE]; /* its place in the request */
    struct proto_points points;
    bool closed, frames;
    double alpha, tension;
    enum gd_tangent_rule tangent_rule;
    enum gd_end_rule end_rule;
    struct proto_segment *tangents; /* owned, one for each point; NULL if not given */
    bool *is_given;                 /* part of the tangents' allocation */
    struct gd_spline_sampling sampling;
    struct proto_reals parameters; /* parameters that the sampling uses */
};

/* Decode the body of a request, or the value of a curve, which has no "at" and no "frames".
 * Problems: invalid_request, too_large (with the limit), insufficient_memory. The caller frees the
 * result by proto_spline_free. */
bool proto_spline_decode(const json_t *document, struct proto_spline *out,
                         struct proto_problem *problem);
bool proto_spline_curve_decode(const json_t *value, const char *place, struct proto_spline *out,
                               struct proto_problem *problem);
void proto_spline_free(struct proto_spline *spline); /* may be called repeatedly */

/* A spline on its mesh. All zero means none. */
struct proto_located_spline {
    /* its pointers point into the memory below; it has no landmarks */
    struct gd_spline_request request;
    struct gd_spline_sampling sampling; /* borrows the spline's parameters */
    struct proto_located_points points;
    struct gd_vector *tangents;
    bool *is_given;
};

/* Locates points and tangents. Problems: those of proto_point_locate and proto_direction_locate,
 * and insufficient_memory. The spline must outlive the located spline. */
bool proto_spline_locate(const struct gd_mesh *mesh, const struct proto_spline *spline,
                         struct proto_located_spline *out, struct proto_problem *problem);
void proto_located_spline_free(struct proto_located_spline *located); /* leaves none */

/* Converts a failure of gd_spline_build or gd_spline_sample into a problem at the faulty point, or
 * at `place`, the place of the spline. Returns false. */
bool proto_spline_fail(const char *place, enum gd_status status, struct gd_detail *detail,
                       struct proto_problem *problem);

/* A sample of an answer. */
struct proto_spline_frame {
    struct gd_frame frame;
    double speed;
};

/* Writes the answer. If `frames` is true, the answer has a frame for each sample. */
void proto_spline_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_spline *spline, const struct gd_spline_line *line,
                         bool frames, const struct proto_options *options);
