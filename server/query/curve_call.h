/* Curve call: one long call of the engine (budgeted_call.h) about a curve of the request, which is
 * made first, with the mesh's landmarks. */
#ifndef SERVER_QUERY_CURVE_CALL_H
#define SERVER_QUERY_CURVE_CALL_H

#include "proto/curve.h"
#include "server/query/query.h"

struct server_curve_call {
    const struct proto_located_curve *curve;
    /* What is made of the curve, which it may take the points of. On success `*kept` bytes are held
     * by the query. */
    enum gd_status (*make)(struct server_query *query, struct gd_curve *curve,
                           const struct gd_control *control, struct gd_detail *detail,
                           size_t *kept);
    size_t grant;     /* bytes that most such calls need */
    double share;     /* of the work, to make the curve */
    const char *what; /* needs the memory */
};

/* False with the problem, which is at the curve's place if that can't be made. */
bool server_curve_call_make(struct server_query *query, const struct server_curve_call *call,
                            struct proto_problem *problem);

#endif
