/* See set_resolve.h. */
#include "server/handlers/set_resolve.h"

#include <stdlib.h>

#include "server/call.h"
#include "server/landmarks.h"

#define BYTES_AN_EDGE 224               /* as for a search (pair_search.c) */
#define BYTES_A_SET   ((size_t)1 << 20) /* on any mesh */
#define WHAT          "the set"

struct resolving {
    const struct gd_mesh *mesh;
    const struct proto_set *set;
    const struct gd_landmarks *landmarks;
    struct proto_located_set **out;
    struct proto_problem *problem;
};

static enum gd_status locate(void *user, const struct gd_control *control, size_t *kept)
{
    const struct resolving *wanted = user;
    enum gd_status status =
        proto_set_locate(wanted->mesh, wanted->set, wanted->landmarks, control, wanted->out, wanted->problem);
    if (!status) *kept = (*wanted->out)->bytes;
    return status;
}

bool server_set_resolve(struct server_query *query, struct server_monitor *part, const struct proto_set *set,
                        struct proto_located_set **out, struct proto_problem *problem)
{
    struct server *server = query->exchange->server;
    struct server_landmark_set *landmarks = server_landmarks_find(server->landmarks, query->surface);
    struct resolving wanted = {query->surface->mesh, set, landmarks ? landmarks->landmarks : NULL, out, problem};
    const struct server_call call = {.make = locate,
                                     .user = &wanted,
                                     .control = server_exchange_control(part),
                                     .grant = BYTES_A_SET +
                                              gd_mesh_summary(query->surface->mesh)->edges * (size_t)BYTES_AN_EDGE};
    enum gd_status status = server_call_make(server, &call);
    server_landmark_set_release(landmarks);
    if (status == GD_BUDGET) server_query_fail(query, status, WHAT, problem);
    return !status;
}

void server_set_release(const struct server_query *query, struct proto_located_set *set, size_t held)
{
    free(set);
    if (held) server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, held);
}
