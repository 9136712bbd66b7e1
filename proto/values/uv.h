/* Parameters: parameter pairs [u, v] of a parametric surface, and plain lists of numbers, in
 * requests and answers. */
#ifndef PROTO_UV_H
#define PROTO_UV_H

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

struct proto_uvs { /* all zero: empty */
    double (*items)[2];
    uint32_t count;
};

void proto_uvs_free(struct proto_uvs *uvs); /* leaves an empty list */

/* Decodes the required member, [u, v]. Problem: invalid_request. */
bool proto_uv_decode(const json_t *object, const char *place, const char *member, double out[2],
                     struct proto_problem *problem);

/* Decodes the required member, a list of 1 to `most` pairs. `place` is the object's. Problems:
 * invalid_request, too_large (with the limit), insufficient_memory. Freed by proto_uvs_free. */
bool proto_uvs_decode(const json_t *object, const char *place, const char *member, uint32_t most,
                      struct proto_uvs *out, struct proto_problem *problem);

/* Decodes the required member, a list of 1 to `most` numbers. Problems as for proto_uvs_decode. The
 * caller frees `*out` by free(). */
bool proto_numbers_decode(const json_t *object, const char *place, const char *member,
                          uint32_t most, double **out, uint32_t *count,
                          struct proto_problem *problem);

/* Checks the number of knots of a B-spline of `points` control points; else invalid_request at the
 * member "knots" of the object at `place`. */
bool proto_knots_check(uint32_t points, uint32_t degree, uint32_t knots, const char *place,
                       struct proto_problem *problem);

/* Checks that `uv` lies in the surface's domain; else point_not_on_surface at `place`. */
bool proto_uv_check(const struct gd_parametric *surface, const double uv[2], const char *place,
                    struct proto_problem *problem);

#endif
