#include "server/query/curve_query.h"

#define RESOLVE_SHARE 0.5 /* of the work */

static enum gd_status curve_make(void *user, const struct gd_control *control, size_t *kept)
{
    struct server_curve_query *own = user;
    struct server_query *query = &own->query;
    struct gd_curve curve;
    own->detail = (struct gd_detail){0};
    *query->part = server_query_monitor(query, 0, RESOLVE_SHARE);
    enum gd_status status = proto_curve_resolve(query->surface->mesh, &own->curve, query->landmarks,
                                                control, &curve, &own->detail);
    own->is_resolved = !status;
    if (status) return status;
    *query->part = server_query_monitor(query, RESOLVE_SHARE, 1 - RESOLVE_SHARE);
    status = own->use->make(own, &curve, control, kept);
    gd_curve_free(&curve);
    return status;
}

bool server_curve_query_solve(struct server_curve_query *query, const struct server_curve_use *use,
                              size_t grant, struct proto_problem *problem)
{
    query->use = use;
    enum gd_status status = server_query_call(&query->query, NULL, curve_make, query, grant);
    if (!status) return true;
    if (status == GD_BUDGET || !query->detail.text[0]) {
        server_query_fail(&query->query, status, use->what, problem);
        return false;
    }
    server_query_count(&query->query, status);
    return query->is_resolved ? proto_problem_from_status(problem, status, &query->detail)
                              : proto_curve_fail(&query->curve, status, &query->detail, problem);
}
