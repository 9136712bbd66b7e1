/* Build: a file's bytes become a surface, within the byte budget. Memory is taken from it step by step, each time before
 * it is used: for the polygons while they are read, for the mesh while it is built. */
#ifndef SERVER_BUILD_H
#define SERVER_BUILD_H

#include "server/budget.h"
#include "server/surface.h"

struct server_builder { /* all borrowed */
    struct server_budget *budget;
    struct server_cache *cache;
    uint32_t max_faces;
    struct gd_control control; /* who ends the build early and hears of its progress; it has no budget of its own */
};

/* The surface of a record from its record->size bytes, or a problem. GD_OK; GD_BUDGET (over the budget; the problem
 * tells the numbers); else what the engine says. The caller has one reference. */
GD_MUST_USE enum gd_status server_build_surface(const struct server_builder *builder, struct server_record *record,
                                                const void *bytes, struct server_surface **out,
                                                struct proto_problem *problem);

#endif
