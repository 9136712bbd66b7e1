/* Direction: how a client names a direction at a point, and how one goes back to the client.
 *
 * Decoding needs no mesh: it checks the form. Locating lays the direction on a mesh at its point:
 * it checks the sense. */
#ifndef PROTO_DIRECTION_H
#define PROTO_DIRECTION_H

#include <jansson.h>

#include "gd/direction.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

#define PROTO_DIRECTION_PLACE 64

struct proto_direction {
    char place[PROTO_DIRECTION_PLACE]; /* where it stood in the request, see problem.h */
    bool has_angle;                    /* else it is the vector */
    double angle;
    struct gd_vec3 xyz;
};

/* From JSON: an angle, a vector [x,y,z], or an object as answers have it: {"angle"}, {"xyz"}, or
 * both, of which the angle counts, being the more exact. `pointer`: the JSON Pointer of `value`,
 * copied. invalid_request. */
bool proto_direction_decode(const json_t *value, const char *pointer, struct proto_direction *out,
                            struct proto_problem *problem);

/* Lays it on the surface at a point. invalid_request (a vector that has no direction there),
 * point_not_on_surface (it leads over the boundary); both at the direction's place. Cost as in
 * gd/direction.h. */
bool proto_direction_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                            const struct proto_direction *direction, struct gd_direction *out,
                            struct proto_problem *problem);

/* Writes {"angle", "xyz"}. */
void proto_direction_encode(struct proto_writer *writer, const struct gd_direction *direction);

#endif
