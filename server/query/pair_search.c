#include "server/query/pair_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/fields/cache.h"
#include "server/query/api.h"
#include "server/surfaces/landmarks.h"
#include "server/work/budgeted_call.h"

/* the arrays of a workspace and the windows of a far pair; see doc/003 */
#define BYTES_AN_EDGE  224
#define BYTES_A_SEARCH ((size_t)1 << 20) /* on a mesh of any size */

struct pair_call {
    const struct gd_mesh *mesh;
    const struct server_pair *pair;
    const struct gd_landmarks *landmarks;
    struct gd_pair_answer *out;
};

/* Keeps nothing: a path is small and soon freed. */
static enum gd_status pair_make(void *user, const struct gd_control *control, size_t *kept)
{
    const struct pair_call *call = user;
    *kept = 0;
    return gd_pair_solve(call->mesh, call->pair->from, call->pair->to, call->pair->wish,
                         call->landmarks, control, call->out, NULL);
}

enum gd_status server_pair_search(struct server_monitor *part, struct server_surface *surface,
                                  const struct server_pair *pair, struct gd_pair_answer *out)
{
    struct server_host *host = part->exchange->host;
    struct server_landmark_set *set = server_landmarks_find(host->api->landmarks, surface);
    struct pair_call search = {surface->mesh, pair, set ? set->landmarks : NULL, out};
    size_t edges = gd_mesh_summary(surface->mesh)->edges;
    const struct server_budgeted_call call = {.make = pair_make,
                                              .user = &search,
                                              .control = server_exchange_control(part),
                                              .grant = BYTES_A_SEARCH + edges * BYTES_AN_EDGE};
    server_metrics_count_search(host->metrics);
    enum gd_status status = server_budgeted_call_run(host->workspaces, &call);
    server_landmark_set_release(set);
    return status;
}

const struct server_cached *server_pair_find_field(struct server_surface *surface,
                                                   const struct server_pair *pair)
{
    const struct server_cached *cached = server_cache_find(surface->fields, pair->from);
    return cached ? cached : server_cache_find(surface->fields, pair->to);
}

enum gd_status server_pair_solve(struct server_monitor *part, struct server_surface *surface,
                                 const struct server_pair *pair, struct gd_pair_answer *out)
{
    const struct server_cached *cached = server_pair_find_field(surface, pair);
    if (!cached) return server_pair_search(part, surface, pair, out);
    enum gd_status status =
        gd_pair_from_field(cached->field, pair->from, pair->to, pair->wish, out);
    server_cache_unpin(cached);
    return status;
}

/* The leg's first point is the route's last one. */
static enum gd_status path_append(struct gd_path *route, const struct gd_path *leg)
{
    uint32_t more = leg->count - 1;
    struct gd_point *points =
        realloc(route->points, ((size_t)route->count + more) * sizeof *points);
    if (!points) return GD_NO_MEMORY;
    memcpy(points + route->count, leg->points + 1, more * sizeof *points);
    route->points = points;
    route->count += more;
    route->length += leg->length;
    return GD_OK;
}

enum gd_status server_pair_append(struct gd_pair_answer *route, struct gd_pair_answer *leg)
{
    enum gd_status status = GD_OK;
    route->distance += leg->distance;
    if (isinf(route->distance)) {
        gd_path_free(&route->path);
    } else if (!route->path.count) {
        route->path = leg->path;
        leg->path = (struct gd_path){0};
    } else {
        status = path_append(&route->path, &leg->path);
    }
    gd_pair_answer_free(leg);
    return status;
}
