/* Parameters: parameter pairs [u, v] of a parametric surface in requests. */
#pragma once

#include "gd/parametric.h"
#include "proto/json/object.h"

struct proto_uvs { /* all zero means empty */
    double (*items)[2];
    uint32_t count;
};

void proto_uvs_free(struct proto_uvs *uvs); /* leaves an empty list */

/* Reads a member that is a list of pairs, as the functions of object.h do. Problems:
 * invalid_request, too_large (with the limit), insufficient_memory. The caller frees the result by
 * proto_uvs_free. */
bool proto_take_uvs(const struct proto_object *object, const struct proto_rule *rule,
                    struct proto_uvs *out);

/* Checks the number of knots of a B-spline with `points` control points. Otherwise fails with
 * invalid_request at the member "knots" of the object at `place`. */
bool proto_knots_check(uint32_t points, uint32_t degree, uint32_t knots, const char *place,
                       struct proto_problem *problem);

/* Checks that `uv` lies in the surface's domain. Otherwise fails with point_not_on_surface at
 * `place`. */
bool proto_uv_check(const struct gd_parametric *surface, const double uv[2], const char *place,
                    struct proto_problem *problem);
