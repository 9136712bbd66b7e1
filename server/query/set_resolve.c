/* See set_resolve.h. */
#include "server/query/set_resolve.h"

#include "server/surfaces/landmarks.h"
#include "server/query/api.h"

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
    enum gd_status status = proto_set_locate(wanted->mesh, wanted->set, wanted->landmarks, control,
                                             wanted->out, wanted->problem);
    if (!status) *kept = (*wanted->out)->bytes;
    return status;
}

bool server_set_resolve(struct server_query *query, struct server_monitor *part,
                        const struct proto_set *set, struct proto_located_set **out,
                        struct proto_problem *problem)
{
    struct server_landmark_set *landmarks =
        server_landmarks_find(query->exchange->host->api->landmarks, query->surface);
    struct resolving wanted = {query->surface->mesh, set, landmarks ? landmarks->landmarks : NULL,
                               out, problem};
    size_t grant =
        BYTES_A_SET + gd_mesh_summary(query->surface->mesh)->edges * (size_t)BYTES_AN_EDGE;
    enum gd_status status = server_query_call(query, part, locate, &wanted, grant);
    server_landmark_set_release(landmarks);
    if (status == GD_BUDGET) server_query_fail(query, status, WHAT, problem);
    return !status;
}
