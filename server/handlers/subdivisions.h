/* Subdivisions: what their handlers share. */
#ifndef SERVER_HANDLERS_SUBDIVISIONS_H
#define SERVER_HANDLERS_SUBDIVISIONS_H

#include "server/handlers/query.h"
#include "server/subdivision.h"

/* As server_query_fail, with what the engine says. A surface whose control points coincide, so that it has no normal somewhere, is the client's: invalid_mesh. FAILED. */
enum server_query_turn server_subdivision_fail(const struct server_query *query, enum gd_status status,
                                               const struct gd_detail *detail, const char *what,
                                               struct proto_problem *problem);

/* The discretization of a level of the query's surface, to be released; the query's work up to `share`. By a worker. */
GD_MUST_USE enum gd_status server_subdivision_discretization(const struct server_query *query, uint32_t level,
                                                             double share, struct server_discretization **out,
                                                             struct gd_detail *detail);

#endif
