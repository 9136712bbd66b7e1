#include "transport/point_paths.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "gd/query.h"
#include "line/route.h"
#include "transport/lanes.h"
#include "wavefront/workspace.h"

struct path_search {
    const struct gd_mesh *mesh;
    const struct gd_spline_request *request;
    struct gd__point_path *paths;
    const uint32_t *order;
    /* workspace of each lane; NULL if each search creates its own workspace */
    struct gd_workspace *workspaces[GD__LANES];
    atomic_size_t held;
};

void gd__point_paths_free(struct gd__point_path *paths, uint32_t count)
{
    for (uint32_t i = 0; i < count && paths; i++) gd_path_free(&paths[i].path);
    free(paths);
}

/* --- one search ------------------------------------------------------------------------------- */

/* Searches one path. The positions of the two points determine at which of them the search starts.
 * So the result does not depend on the order of the points, even if several paths are equally
 * short. */
static enum gd_status path_search_one(struct path_search *search, struct gd__point_path *point_path,
                                      const struct gd_control *control)
{
    const struct gd_point *from = &search->request->points[point_path->from],
                          *to = &search->request->points[point_path->to];
    bool is_swapped = gd__point_follows(from, to);
    struct gd_pair_answer answer;
    enum gd_status status =
        gd_pair_solve(search->mesh,
                      &(struct gd_pair_request){.from = is_swapped ? to : from,
                                                .to = is_swapped ? from : to,
                                                .output = GD_PAIR_PATH_AND_CUT,
                                                .landmarks = search->request->landmarks},
                      control, &answer, NULL);
    if (status) return status;
    if (is_swapped) gd__points_reverse(answer.path.points, answer.path.count);
    point_path->path = answer.path;
    point_path->is_cut = answer.is_cut;
    atomic_fetch_add(&search->held, answer.path.count * sizeof *answer.path.points);
    return GD_OK;
}

static enum gd_status path_search_make(void *context, uint32_t lane, uint32_t i,
                                       const struct gd_control *control)
{
    struct path_search *search = context;
    struct gd__point_path *point_path = &search->paths[search->order[i]];
    struct gd_control own = *control;
    size_t held = atomic_load(&search->held);
    if (point_path->path.count) return GD_OK;
    /* 0 means no limit */
    if (own.budget_bytes) own.budget_bytes = own.budget_bytes > held ? own.budget_bytes - held : 1;
    own.workspace = search->workspaces[lane];
    /* if two searches at a time exceeded the budget, this search needs the memory of the other
       lane */
    if (lane == GD__LANE_ALONE && search->workspaces[1]) gd_workspace_trim(search->workspaces[1]);
    return path_search_one(search, point_path, &own);
}

/* --- all searches ----------------------------------------------------------------------------- */

struct span {
    double length;
    uint32_t point_path;
};

static int by_length(const void *a, const void *b)
{
    const struct span *s = a, *t = b;
    if (s->length != t->length) return s->length < t->length ? 1 : -1;
    return (s->point_path > t->point_path) - (s->point_path < t->point_path);
}

/* Sorts the paths that must be searched, the longest first. If a long search came last, the other
 * lane would be idle. Sets *count to the number of paths. */
static uint32_t *sort(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                      const struct gd__point_path *paths, uint32_t *count)
{
    uint32_t *order = malloc(*count * sizeof *order), wanted = 0;
    struct span *spans = malloc(*count * sizeof *spans);
    for (uint32_t i = 0; i < *count && order && spans; i++) {
        if (paths[i].from == paths[i].to) continue;
        struct gd_vec3 from = gd_point_position(mesh, &request->points[paths[i].from]),
                       to = gd_point_position(mesh, &request->points[paths[i].to]);
        spans[wanted++] = (struct span){gd_vec3_distance(from, to), i};
    }
    if (order && spans) {
        qsort(spans, wanted, sizeof *spans, by_length);
        for (uint32_t i = 0; i < wanted; i++) order[i] = spans[i].point_path;
        *count = wanted;
    } else {
        free(order);
        order = NULL;
    }
    free(spans);
    return order;
}

static enum gd_status check_joined(const struct gd_mesh *mesh,
                                   const struct gd_spline_request *request,
                                   const struct gd__point_path *paths, uint32_t count,
                                   struct gd_detail *detail)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = paths[i].from, to = paths[i].to;
        if (gd_point_component(mesh, &request->points[from]) ==
            gd_point_component(mesh, &request->points[to]))
            continue;
        gd_fail(detail, GD_INVALID_ARGUMENT,
                "points %u and %u of the spline lie on components that no path joins", from, to);
        gd_detail_add(detail, GD_ELEMENT_NONE, to, 0);
        return GD_INVALID_ARGUMENT;
    }
    return GD_OK;
}

enum gd_status gd__point_paths_search(const struct gd_mesh *mesh,
                                      const struct gd_spline_request *request,
                                      struct gd__share *share, struct gd__point_path *paths,
                                      uint32_t count, struct gd_detail *detail)
{
    enum gd_status status = check_joined(mesh, request, paths, count, detail);
    if (status) return status;
    uint32_t *order = sort(mesh, request, paths, &count);
    const struct gd_control control = gd__share_control(share, 0);
    struct path_search search = {.mesh = mesh, .request = request, .paths = paths, .order = order};
    search.workspaces[0] = search.workspaces[GD__LANE_ALONE] = control.workspace;
    if (control.workspace && request->executor)
        search.workspaces[1] = gd__workspace_partner(control.workspace);
    atomic_init(&search.held, 0);
    const struct gd__lanes lanes = {request->executor, &control, share, count,
                                    path_search_make,  &search};
    status = order ? gd__lanes_run(&lanes) : GD_NO_MEMORY;
    free(order);
    return status ? gd_fail_status(detail, status) : GD_OK;
}
