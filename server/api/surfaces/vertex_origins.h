/* Vertex origins: where on a smooth surface the vertices of a mesh lie that was made of it. They
 * are the mesh's attachment; GET …/parameters (NURBS) and GET …/places (subdivision surfaces) tell
 * them. */
#ifndef SERVER_API_SURFACES_VERTEX_ORIGINS_H
#define SERVER_API_SURFACES_VERTEX_ORIGINS_H

#include "gd/discretization.h"
#include "gd/tessellation.h"
#include "server/query/derived_mesh.h"
#include "server/query/query.h"

/* Adds a mesh of the query's surface to a making, whose attachment its vertices' origins become.
 * False with the problem. */
bool server_vertex_parameters_make(const struct server_query *query, const char *name,
                                   const struct gd_tessellation *tessellation,
                                   struct server_derived_meshes *making,
                                   struct proto_problem *problem);
bool server_vertex_places_make(const struct server_query *query, const char *name,
                               const struct gd_discretization *fine,
                               struct server_derived_meshes *making, struct proto_problem *problem);

/* Stores the one mesh of a making and answers as an upload does. By the registry's writer. */
bool server_vertex_origins_store(struct server_exchange *exchange,
                                 struct server_derived_meshes *making);

#endif
