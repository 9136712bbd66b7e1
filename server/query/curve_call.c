/* See curve_call.h. */
#include "server/query/curve_call.h"

#include "server/surfaces/landmarks.h"
#include "server/query/api.h"

struct making {
    struct server_query *query;
    const struct server_curve_call *call;
    const struct gd_landmarks *landmarks;
    struct server_monitor part; /* the call's */
    bool has_curve;             /* the curve is not what failed */
    struct gd_detail detail;
};

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct making *making = user;
    struct server_query *query = making->query;
    const struct server_curve_call *call = making->call;
    struct gd_curve curve;
    making->detail = (struct gd_detail){0};
    making->part = server_query_monitor(query, 0, call->share);
    enum gd_status status = proto_curve_resolve(
        query->surface->mesh, call->curve, making->landmarks, control, &curve, &making->detail);
    making->has_curve = !status;
    if (status) return status;
    making->part = server_query_monitor(query, call->share, 1 - call->share);
    status = call->make(query, &curve, control, &making->detail, kept);
    gd_curve_free(&curve);
    return status;
}

static bool fail(struct making *making, enum gd_status status, struct proto_problem *problem)
{
    if (status == GD_BUDGET || !making->detail.text[0])
        return server_query_fail(making->query, status, making->call->what, problem) ==
               SERVER_QUERY_DONE;
    server_query_count(making->query, status);
    if (!making->has_curve)
        return proto_curve_fail(making->call->curve, status, &making->detail, problem);
    return proto_problem_from_status(problem, status, &making->detail);
}

bool server_curve_call_make(struct server_query *query, const struct server_curve_call *call,
                            struct proto_problem *problem)
{
    struct server_landmark_set *set =
        server_landmarks_find(query->exchange->host->api->landmarks, query->surface);
    struct making making = {.query = query,
                            .call = call,
                            .landmarks = set ? set->landmarks : NULL,
                            .part = server_query_monitor(query, 0, call->share)};
    enum gd_status status = server_query_call(query, &making.part, make, &making, call->grant);
    server_landmark_set_release(set);
    return !status || fail(&making, status, problem);
}
