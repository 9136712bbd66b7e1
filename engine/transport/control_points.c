#include "transport/control_points.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "gd/query.h"
#include "line/route.h"
#include "base/lanes.h"
#include "wavefront/workspace.h"

/* --- searches --------------------------------------------------------------------------------- */

/* Point paths: searches the shortest paths between the points of a spline, one after the other or,
 * with an executor, two at a time. */

/* A path to be searched, with the straight distance between its ends. */
struct span {
    double length;
    uint32_t point_path;
};

struct path_search {
    const struct gd_mesh *mesh;
    const struct gd_spline_request *request;
    struct gd__point_path *paths;
    const struct span *spans; /* in the order of the searches */
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
    struct gd__point_path *point_path = &search->paths[search->spans[i].point_path];
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

static int by_length(const void *a, const void *b)
{
    const struct span *s = a, *t = b;
    if (s->length != t->length) return s->length < t->length ? 1 : -1;
    return (s->point_path > t->point_path) - (s->point_path < t->point_path);
}

/* Lists the paths that must be searched, the longest first. If a long search came last, the other
 * lane would be idle. Returns their number. */
static uint32_t list_spans(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                           const struct gd__point_path *paths, uint32_t count, struct span *out)
{
    uint32_t wanted = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (paths[i].from == paths[i].to) continue;
        struct gd_vec3 from = gd_point_position(mesh, &request->points[paths[i].from]),
                       to = gd_point_position(mesh, &request->points[paths[i].to]);
        out[wanted++] = (struct span){gd_vec3_distance(from, to), i};
    }
    qsort(out, wanted, sizeof *out, by_length);
    return wanted;
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

/* Searches `count` paths between the points of the request, the longest first. Each path is one
 * part of the share. On failure, the paths found so far stay in `paths`. Two simultaneous searches
 * get half of the budget each. If this is too little, the searches run one after the other. Only
 * the caller's thread reports progress. Errors: GD_INVALID_ARGUMENT (no path joins two of the
 * points), and those of gd_pair_solve. */
static enum gd_status point_paths_search(const struct gd_mesh *mesh,
                                         const struct gd_spline_request *request,
                                         struct gd__share *share, struct gd__point_path *paths,
                                         uint32_t count, struct gd_detail *detail)
{
    enum gd_status status = check_joined(mesh, request, paths, count, detail);
    if (status) return status;
    struct span *spans = malloc(count * sizeof *spans);
    if (!spans) return gd_fail_status(detail, GD_NO_MEMORY);
    count = list_spans(mesh, request, paths, count, spans);
    const struct gd_control control = gd__share_control(share, 0);
    struct path_search search = {.mesh = mesh, .request = request, .paths = paths, .spans = spans};
    search.workspaces[0] = search.workspaces[GD__LANE_ALONE] = control.workspace;
    if (control.workspace && request->executor)
        search.workspaces[1] = gd__workspace_partner(control.workspace);
    atomic_init(&search.held, 0);
    const struct gd__lanes lanes = {request->executor, &control, share, count,
                                    path_search_make,  &search};
    status = gd__lanes_run(&lanes);
    free(spans);
    return status ? gd_fail_status(detail, status) : GD_OK;
}

/* --- paths ------------------------------------------------------------------------------------ */

static enum gd_status control_points_refuse(const struct gd__spline_work *work, uint32_t which,
                                            const char *sentence, uint32_t other)
{
    gd_fail(work->detail, GD_INVALID_ARGUMENT, sentence, other, which);
    if (work->detail) gd_detail_add(work->detail, GD_ELEMENT_NONE, which, 0);
    return GD_INVALID_ARGUMENT;
}

/* Rejects equal consecutive points, because no direction leads from one to the other. */
static enum gd_status check_apart(const struct gd__spline_work *work)
{
    double longest = 0;
    for (uint32_t i = 0; i < work->path_count; i++)
        longest = fmax(longest, work->paths[i].path.length);
    for (uint32_t i = 0; i < work->path_count; i++) {
        if (work->paths[i].path.length > GD_TOL_SAME_POINT * longest) continue;
        if (i + 1 == work->request->count)
            return control_points_refuse(work, i,
                                         "point %u equals point %u; leave one of them out, because "
                                         "a closed spline joins its ends",
                                         0);
        return control_points_refuse(
            work, i + 1, "points %u and %u of the spline are equal; leave one of them out", i);
    }
    return GD_OK;
}

static bool is_given(const struct gd_spline_request *request, uint32_t i)
{
    return request->tangents && (!request->is_given || request->is_given[i]);
}

static uint32_t point_before(const struct gd__spline_work *work, uint32_t i)
{
    return i ? i - 1 : work->path_count - 1;
}

enum gd_status gd__control_points_search(struct gd__spline_work *work)
{
    const struct gd_spline_request *request = work->request;
    uint32_t paths = work->path_count, count = request->count;
    for (uint32_t i = 0; i < paths; i++)
        work->paths[i] = (struct gd__point_path){.from = i, .to = (i + 1) % count};
    for (uint32_t i = request->closed ? 0 : 1; i < paths && work->total_count > paths; i++)
        if (!is_given(request, i))
            work->paths[paths + i] =
                (struct gd__point_path){.from = point_before(work, i), .to = (i + 1) % count};
    enum gd_status status = point_paths_search(work->mesh, request, work->share, work->paths,
                                               work->total_count, work->detail);
    return status ? status : check_apart(work);
}

/* --- vectors ---------------------------------------------------------------------------------- */

/* Copies a path, backwards if requested. The caller frees out->points by free(). */
static enum gd_status turn_path(const struct gd__spline_work *work, const struct gd_path *path,
                                bool backwards, struct gd_path *out)
{
    struct gd__route copy = {0};
    enum gd_status status =
        gd__route_join(&copy, path->points, path->count, 0, backwards, work->control);
    *out = (struct gd_path){path->length, copy.count, copy.points};
    return status;
}

/* Computes the vector of a path at its beginning, or of the reversed path at its end. */
static enum gd_status log_of(const struct gd__spline_work *work, const struct gd_path *path,
                             bool backwards, struct gd_vector *out)
{
    struct gd_path turned;
    struct gd_log log;
    enum gd_status status = turn_path(work, path, backwards, &turned);
    if (!status) status = gd_vector_log(work->mesh, &turned, &log, work->detail);
    gd_path_free(&turned);
    if (status) return status;
    *out = log.vector;
    gd_log_free(&log);
    return GD_OK;
}

/* Transports the tangent at the other end of a path to the path's beginning or end. */
static enum gd_status control_points_moved(const struct gd__spline_work *work,
                                           const struct gd_path *path, bool to_beginning,
                                           const struct gd_vector *vector, struct gd_vector *out)
{
    struct gd_path turned;
    struct gd_vector own = *vector;
    enum gd_status status = turn_path(work, path, to_beginning, &turned);
    if (!status) status = gd_vector_transport(work->mesh, &turned, &own, 1, work->detail);
    if (!status) *out = own;
    gd_path_free(&turned);
    return status;
}

/* --- inner points ----------------------------------------------------------------------------- */

/* Returns (1 - c) / (u_(i+1) - u_(i-1)), where c is the tension and u the parameters. */
static double control_points_slope_at(const struct gd__spline_work *work, uint32_t i)
{
    const struct gd_spline_knot *knots = work->knots;
    uint32_t last = point_before(work, i);
    return (1 - work->request->tension) / (knots[i + 1].parameter - knots[i].parameter +
                                           knots[last + 1].parameter - knots[last].parameter);
}

static enum gd_status symmetric_tangent(const struct gd__spline_work *work, uint32_t i,
                                        struct gd_vector *out)
{
    double slope = control_points_slope_at(work, i);
    struct gd_vector vectors[2];
    enum gd_status status = log_of(work, &work->paths[i].path, false, &vectors[0]);
    if (!status) status = log_of(work, &work->paths[point_before(work, i)].path, true, &vectors[1]);
    if (!status)
        *out = gd_vector_combine(work->mesh, &work->request->points[i], vectors,
                                 (double[2]){slope, -slope}, 2);
    return status;
}

static enum gd_status paper_tangent(const struct gd__spline_work *work, uint32_t i,
                                    struct gd_vector *out)
{
    const struct gd_path *chord = &work->paths[work->path_count + i].path;
    struct gd_vector vector = {0};
    if (!chord->count) { /* the two neighbours are the same point */
        *out = gd_vector_combine(work->mesh, &work->request->points[i], NULL, NULL, 0);
        return GD_OK;
    }
    enum gd_status status = log_of(work, chord, false, &vector);
    vector.length *= control_points_slope_at(work, i);
    return status ? status
                  : control_points_moved(work, &work->paths[point_before(work, i)].path, false,
                                         &vector, out);
}

/* --- ends ------------------------------------------------------------------------------------- */

/* Computes the natural tangent (3/2) w / D - v / 2 at an end. D is the difference of the parameters
 * of the end and its neighbour, and v the neighbour's tangent, transported to the end. The vector w
 * has the length of the path between them and points forward along the curve: at the first point
 * towards the neighbour, at the last point away from it. A spline of two points without given
 * tangents has the tangents w / D. */
static enum gd_status natural_tangent(const struct gd__spline_work *work, bool at_end,
                                      bool is_alone, struct gd_vector *out)
{
    uint32_t index = at_end ? work->path_count - 1 : 0, here = index + at_end,
             neighbour = index + !at_end;
    const struct gd_spline_knot *knots = work->knots;
    double slope = (at_end ? -1 : 1) / (knots[index + 1].parameter - knots[index].parameter);
    struct gd_vector vectors[2] = {0};
    enum gd_status status = log_of(work, &work->paths[index].path, at_end, &vectors[0]);
    if (!status && !is_alone)
        status = control_points_moved(work, &work->paths[index].path, !at_end,
                                      &knots[neighbour].tangent, &vectors[1]);
    if (status) return status;
    *out = gd_vector_combine(work->mesh, &work->request->points[here], vectors,
                             (double[2]){is_alone ? slope : 1.5 * slope, -0.5}, is_alone ? 1 : 2);
    return GD_OK;
}

static enum gd_status fill_ends(const struct gd__spline_work *work)
{
    const struct gd_spline_request *request = work->request;
    enum gd_status status = GD_OK;
    uint32_t last = work->path_count;
    bool first_is_given = is_given(request, 0), last_is_given = is_given(request, last);
    bool is_alone = last == 1 && !first_is_given && !last_is_given;
    if (request->end_rule == GD_END_ZERO) return GD_OK;
    if (!first_is_given) status = natural_tangent(work, false, is_alone, &work->knots[0].tangent);
    if (!last_is_given && !status)
        status = natural_tangent(work, true, is_alone, &work->knots[last].tangent);
    return status;
}

/* --- all points ------------------------------------------------------------------------------- */

static void fill_parameters(const struct gd__spline_work *work)
{
    double parameter = 0;
    for (uint32_t i = 0; i <= work->path_count; i++) {
        work->knots[i].parameter = parameter;
        if (i < work->path_count)
            parameter += pow(work->paths[i].path.length, work->request->alpha);
    }
}

static enum gd_status fill_inner(const struct gd__spline_work *work)
{
    const struct gd_spline_request *request = work->request;
    bool is_symmetric = request->tangent_rule == GD_TANGENT_SYMMETRIC;
    enum gd_status status = GD_OK;
    for (uint32_t i = request->closed ? 0 : 1; i < work->path_count && !status; i++) {
        struct gd_vector *out = &work->knots[i].tangent;
        if (is_given(request, i)) continue;
        status = is_symmetric ? symmetric_tangent(work, i, out) : paper_tangent(work, i, out);
    }
    return status;
}

enum gd_status gd__control_points_fill(const struct gd__spline_work *work)
{
    const struct gd_spline_request *request = work->request;
    fill_parameters(work);
    for (uint32_t i = 0; i < request->count; i++)
        if (is_given(request, i)) work->knots[i].tangent = request->tangents[i];
    enum gd_status status = fill_inner(work);
    if (status) return status;
    if (!request->closed) return fill_ends(work);
    work->knots[work->path_count].tangent = work->knots[0].tangent;
    return GD_OK;
}
