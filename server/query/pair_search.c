/* See pair_search.h. */
#include "server/query/pair_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/work/budgeted_call.h"
#include "server/query/api.h"

/* the arrays of a workspace and the windows of a far pair; see doc/003 */
#define BYTES_AN_EDGE 224
#define BYTES_A_SEARCH                                                                             \
    ((size_t)1 << 20) /* on any mesh: the queue, and what is taken in advance                      \
                       */

struct search {
    const struct gd_mesh *mesh;
    const struct gd_point *from, *to;
    enum gd_pair_wish wish;
    const struct gd_landmarks *landmarks;
    struct gd_pair_answer *out;
};

static enum gd_status search(void *user, const struct gd_control *control, size_t *kept)
{
    const struct search *wanted = user;
    *kept = 0; /* a path is small, and soon gone */
    return gd_pair_solve(wanted->mesh, wanted->from, wanted->to, wanted->wish, wanted->landmarks,
                         control, wanted->out, NULL);
}

enum gd_status server_pair_search(struct server_monitor *part, const struct gd_mesh *mesh,
                                  const struct gd_point *from, const struct gd_point *to,
                                  enum gd_pair_wish wish, const struct gd_landmarks *landmarks,
                                  struct gd_pair_answer *out)
{
    struct search wanted = {mesh, from, to, wish, landmarks, out};
    const struct server_budgeted_call call = {
        .make = search,
        .user = &wanted,
        .control = server_exchange_control(part),
        .grant = BYTES_A_SEARCH + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE};
    server_metrics_count_search(part->exchange->host->metrics);
    return server_budgeted_call_run(part->exchange->host->workspaces, &call);
}

/* --- routes ----------------------------------------------------------------------------------- */

/* The leg's first point is the route's last one. */
static enum gd_status append_path(struct gd_path *route, const struct gd_path *leg)
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
        status = append_path(&route->path, &leg->path);
    }
    gd_pair_answer_free(leg);
    return status;
}
