/* Limit place: a point of a subdivision surface (schema LimitPlace) in requests and answers. */
#pragma once

#include "gd/limit_place.h"
#include "generated/requests.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

struct proto_limit_places { /* all zero is an empty list */
    struct gd_limit_point *items;
    uint32_t count;
};

void proto_limit_places_free(struct proto_limit_places *places); /* leaves an empty list */

/* Locates a place on its surface. `pointer` is its place in the request. Problems: invalid_request
 * (face or corner), point_not_on_surface (u, v outside of the face). */
bool proto_limit_place_locate(const struct gd_subdivision *surface,
                              const struct proto_limit_place *place, const char *pointer,
                              struct gd_limit_point *out, struct proto_problem *problem);

/* Locates the places of the member "points". Problems: those of proto_limit_place_locate, and
 * insufficient_memory. */
bool proto_limit_places_locate(const struct gd_subdivision *surface,
                               const struct proto_limit_place_list *list,
                               struct proto_limit_places *out, struct proto_problem *problem);

void proto_limit_place_encode(struct proto_writer *writer, const struct gd_limit_point *place,
                              struct gd_vec3 xyz);
