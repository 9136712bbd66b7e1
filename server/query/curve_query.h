/* Curve query: a query that resolves a curve on the mesh, then makes something of it. */
#ifndef SERVER_QUERY_CURVE_QUERY_H
#define SERVER_QUERY_CURVE_QUERY_H

#include "proto/curve.h"
#include "server/query/query.h"

/* Begins a kind's own struct. The kind has uses_landmarks. */
struct server_curve_query {
    struct server_query query; /* first */
    struct proto_located_curve curve;
    const struct server_curve_use *use;
    struct gd_detail detail; /* of a failure */
    bool is_resolved;
};

struct server_curve_use {
    /* May take the points of the curve. On success the query holds `*kept` bytes. */
    enum gd_status (*make)(struct server_curve_query *query, struct gd_curve *curve,
                           const struct gd_control *control, size_t *kept);
    const char *what; /* needs the memory */
};

/* Resolves the curve and makes the use of it in one long call, by a worker. Half of the work is to
 * resolve. False with the problem, which is at the curve's place if it can't be resolved. */
bool server_curve_query_solve(struct server_curve_query *query, const struct server_curve_use *use,
                              size_t grant, struct proto_problem *problem);

#endif
