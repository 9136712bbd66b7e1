/* Smooth surfaces: code shared by the queries on NURBS and on subdivision surfaces. */
#ifndef SERVER_API_SMOOTH_SMOOTH_H
#define SERVER_API_SMOOTH_SMOOTH_H

#include "server/query/query.h"

/* As server_query_fail, with the engine's detail in the problem. Coinciding control points leave a
 * surface without a normal somewhere: this is the client's invalid_mesh, not an internal error.
 * Returns FAILED. */
enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what);

#endif
