/* Limit place: a place of a subdivision surface in requests and answers,
 *
 *     {"face": 3, "uv": [u, v], "corner": 0}
 *
 * `corner` is of polygons of n != 4 corners only and may be left out when it is 0. */
#ifndef PROTO_LIMIT_PLACE_H
#define PROTO_LIMIT_PLACE_H

#include "gd/limit_place.h"
#include "generated/requests.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

struct proto_limit_places { /* all zero is an empty list */
    struct gd_limit_point *items;
    uint32_t count;
};

void proto_limit_places_free(struct proto_limit_places *places); /* leaves an empty list */

/* The place on its surface; `pointer`: where it stood in the request. invalid_request (its face or
 * its corner), point_not_on_surface (u, v outside of the face). */
bool proto_limit_place_locate(const struct gd_subdivision *surface,
                              const struct proto_limit_place *place, const char *pointer,
                              struct gd_limit_point *out, struct proto_problem *problem);

/* Those of the member "points". The same problems, and insufficient_memory. */
bool proto_limit_places_locate(const struct gd_subdivision *surface,
                               const struct proto_limit_place_list *list,
                               struct proto_limit_places *out, struct proto_problem *problem);

/* Writes the members of a place into an object that is begun. */
void proto_limit_place_write(struct proto_writer *writer, const struct gd_limit_point *place);

/* Writes {"face", "uv", "xyz"}. */
void proto_limit_place_encode(struct proto_writer *writer, const struct gd_limit_point *place,
                              struct gd_vec3 xyz);

#endif
