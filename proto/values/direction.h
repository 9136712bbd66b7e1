/* Direction: a direction at a point, in requests and answers.
 *
 * Decoding checks the form and needs no mesh. Locating computes the direction on a mesh at its
 * point, and checks that the direction is possible there. */
#pragma once

#include <jansson.h>

#include "gd/direction.h"
#include "proto/json/object.h"
#include "proto/json/writer.h"

struct proto_direction {
    char place[PROTO_KEPT_PLACE]; /* its place in the request, see problem.h */
    bool has_angle;               /* true if `angle` is used; false if `xyz` is used */
    double angle;
    struct gd_vec3 xyz;
};

/* Decodes an angle, a vector [x,y,z], or an object as in answers: {"angle"}, {"xyz"}, or both. If
 * both are present, the angle is used, because it is more exact. `pointer` is the JSON Pointer of
 * `value`, copied. Problem: invalid_request. */
bool proto_direction_decode(const json_t *value, const char *pointer, struct proto_direction *out,
                            struct proto_problem *problem);

/* Computes the direction on the surface at a point. Problems at the direction's place:
 * invalid_request (the vector has no direction at the point), point_not_on_surface (the direction
 * leads over the boundary). Cost as in gd/direction.h. */
bool proto_direction_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                            const struct proto_direction *direction, struct gd_direction *out,
                            struct proto_problem *problem);

void proto_direction_encode(struct proto_writer *writer, const struct gd_direction *direction);
