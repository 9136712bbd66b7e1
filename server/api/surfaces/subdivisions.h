/* Subdivisions: what their handlers share. */
#ifndef SERVER_API_SURFACES_SUBDIVISIONS_H
#define SERVER_API_SURFACES_SUBDIVISIONS_H

#include "server/api/smooth/smooth.h"
#include "server/surfaces/kinds.h"

/* The discretization of a level of the query's surface, to be released; the query's work up to
 * `share`. By a worker. */
GD_MUST_USE enum gd_status server_subdivision_discretization(const struct server_query *query,
                                                             uint32_t level, double share,
                                                             struct server_discretization **out,
                                                             struct gd_detail *detail);

#endif
