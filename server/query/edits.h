/* Edits: runs the edits of a request on a surface and makes the result a derived mesh
 * (surface_resource.h). The attachment of the mesh holds the origins of its vertices (derived.h).
 *
 *     struct server_edits edits = {.surface = …, .edits = …};
 *     server_edits_run(&edits, &monitor, &problem) &&
 *         server_edits_add(&edits, &edits.edited, &meshes, name, &problem);
 *     server_edits_free(&edits); */
#pragma once

#include "proto/queries/derive.h"
#include "server/query/surface_resource.h"

struct server_edits {
    const struct server_surface *surface; /* borrowed */
    bool is_upload; /* true if the surface comes from an uploaded file and has no name */
    struct proto_edits edits;
    struct gd_edited edited;      /* the result */
    struct server_budget *budget; /* server_edits_run sets this member and the next */
    size_t held;                  /* bytes of SERVER_BUDGET_FLIGHT */
};

/* Runs the edits on a worker. `part` monitors the edits as a part of the exchange's progress. On
 * failure, returns false with the problem. */
bool server_edits_run(struct server_edits *edits, struct server_monitor *part,
                      struct proto_problem *problem);

/* Releases the mesh that was built to measure the result, if there is one. The polygons stay. */
void server_edits_drop_mesh(struct server_edits *edits);

/* Adds a mesh to be stored under that name: the result or a part of it. On failure, returns false
 * with the problem. */
bool server_edits_add(const struct server_edits *edits, const struct gd_edited *edited,
                      struct server_derived_meshes *meshes, const char *name,
                      struct proto_problem *problem);

/* Adds a mesh for each component of the result, named NAME-1, NAME-2, …. On failure, returns false
 * with the problem. */
bool server_edits_add_parts(struct server_edits *edits, struct server_monitor *part,
                            struct server_derived_meshes *meshes, const char *name,
                            struct proto_problem *problem);

void server_edits_free(struct server_edits *edits); /* accepts all zero */
