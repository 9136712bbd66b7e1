#include "transport/hops.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "gd/query.h"
#include "line/route.h"
#include "wavefront/workspace.h"

/* Searches have nothing to do with each other, so each lane takes the next one when it is done. A
 * thread is known by where its own copy of `here` lies. */

enum { LANES_MOST = 2 }; /* a workspace has one partner */

static _Thread_local char here;

struct hunt {
    const struct gd_mesh *mesh;
    const struct gd_spline_request *request;
    struct gd__share *share;
    struct gd_control control; /* the caller's, of the whole */
    const char *home;          /* the caller's thread */
    struct gd__hop *hops;
    const uint32_t *order;
    uint32_t count, lanes;
    struct gd_workspace *workspaces[LANES_MOST]; /* NULL: a search has its own */
    atomic_uint next, done;
    atomic_size_t held;
    atomic_int status; /* the first failure, by which the other lane ends too */
};

void gd__hops_free(struct gd__hop *hops, uint32_t count)
{
    for (uint32_t i = 0; i < count && hops; i++) gd_path_free(&hops[i].path);
    free(hops);
}

/* --- one search ------------------------------------------------------------------------------- */

static bool report(void *user, double fraction)
{
    struct hunt *hunt = user;
    if (atomic_load(&hunt->status)) return false;
    if (&here != hunt->home || !hunt->control.progress) return true;
    hunt->share->done = atomic_load(&hunt->done);
    return hunt->control.progress(hunt->control.user, fraction);
}

static struct gd_control control_of(struct hunt *hunt, struct gd_workspace *workspace)
{
    struct gd_control own = hunt->control;
    size_t held = atomic_load(&hunt->held);
    /* 0: no limit */
    if (own.budget_bytes) own.budget_bytes = own.budget_bytes > held ? own.budget_bytes - held : 1;
    if (own.budget_bytes > hunt->lanes) own.budget_bytes /= hunt->lanes;
    own.progress = report;
    own.user = hunt;
    own.workspace = workspace;
    return own;
}

/* It is searched in the order of the points' places, so that reversed points have the same paths
 * even where there are several. */
static enum gd_status search(struct hunt *hunt, struct gd__hop *hop,
                             const struct gd_control *control)
{
    const struct gd_point *from = &hunt->request->points[hop->from],
                          *to = &hunt->request->points[hop->to];
    bool is_swapped = gd__point_follows(from, to);
    struct gd_pair_answer answer;
    enum gd_status status =
        gd_pair_solve(hunt->mesh,
                      &(struct gd_pair_request){.from = is_swapped ? to : from,
                                                .to = is_swapped ? from : to,
                                                .wish = GD_PAIR_PATH_AND_CUT,
                                                .landmarks = hunt->request->landmarks},
                      control, &answer, NULL);
    if (status) return status;
    if (is_swapped) gd__points_reverse(answer.path.points, answer.path.count);
    hop->path = answer.path;
    hop->is_cut = answer.is_cut;
    atomic_fetch_add(&hunt->held, answer.path.count * sizeof *answer.path.points);
    return GD_OK;
}

/* --- all of them ------------------------------------------------------------------------------ */

static void search_lane(void *context, uint32_t lane)
{
    struct hunt *hunt = context;
    for (uint32_t i;
         !atomic_load(&hunt->status) && (i = atomic_fetch_add(&hunt->next, 1)) < hunt->count;) {
        struct gd__hop *hop = &hunt->hops[hunt->order[i]];
        const struct gd_control own = control_of(hunt, hunt->workspaces[lane]);
        int none = GD_OK;
        if (hop->path.count) continue;
        enum gd_status status = search(hunt, hop, &own);
        if (status) atomic_compare_exchange_strong(&hunt->status, &none, (int)status);
        atomic_fetch_add(&hunt->done, 1);
    }
}

static enum gd_status search_in_lanes(struct hunt *hunt, uint32_t lanes)
{
    hunt->lanes = lanes;
    hunt->workspaces[0] = hunt->control.workspace;
    if (lanes > 1 && hunt->control.workspace)
        hunt->workspaces[1] = gd__workspace_partner(hunt->control.workspace);
    atomic_store(&hunt->next, 0);
    atomic_store(&hunt->status, GD_OK);
    gd_executor_run(lanes > 1 ? hunt->request->executor : NULL, search_lane, hunt, lanes);
    hunt->share->done = atomic_load(&hunt->done);
    return (enum gd_status)atomic_load(&hunt->status);
}

/* Two need more memory than one. */
static enum gd_status search_all(struct hunt *hunt)
{
    const struct gd_executor *executor = hunt->request->executor;
    uint32_t before = hunt->share->done;
    atomic_init(&hunt->done, before);
    enum gd_status status =
        search_in_lanes(hunt, executor && executor->width > 1 && hunt->count > 1 ? LANES_MOST : 1);
    if (status != GD_BUDGET || hunt->lanes == 1) return status;
    if (hunt->workspaces[1]) gd_workspace_trim(hunt->workspaces[1]);
    return search_in_lanes(hunt, 1);
}

struct span {
    double length;
    uint32_t hop;
};

static int by_length(const void *a, const void *b)
{
    const struct span *s = a, *t = b;
    if (s->length != t->length) return s->length < t->length ? 1 : -1;
    return (s->hop > t->hop) - (s->hop < t->hop);
}

/* A long search that came last would leave the other lane without work. The order: of the hops that
 * are wanted, whose number is *count. */
static uint32_t *sort(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                      const struct gd__hop *hops, uint32_t *count)
{
    uint32_t *order = malloc(*count * sizeof *order), wanted = 0;
    struct span *spans = malloc(*count * sizeof *spans);
    for (uint32_t i = 0; i < *count && order && spans; i++) {
        if (hops[i].from == hops[i].to) continue;
        struct gd_vec3 from = gd_point_position(mesh, &request->points[hops[i].from]),
                       to = gd_point_position(mesh, &request->points[hops[i].to]);
        spans[wanted++] = (struct span){gd_vec3_distance(from, to), i};
    }
    if (order && spans) {
        qsort(spans, wanted, sizeof *spans, by_length);
        for (uint32_t i = 0; i < wanted; i++) order[i] = spans[i].hop;
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
                                   const struct gd__hop *hops, uint32_t count,
                                   struct gd_detail *detail)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = hops[i].from, to = hops[i].to;
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

enum gd_status gd__hops_search(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                               struct gd__share *share, struct gd__hop *hops, uint32_t count,
                               struct gd_detail *detail)
{
    enum gd_status status = check_joined(mesh, request, hops, count, detail);
    if (status) return status;
    uint32_t *order = sort(mesh, request, hops, &count);
    struct hunt hunt = {.mesh = mesh,
                        .request = request,
                        .share = share,
                        .control = gd__share_control(share, 0),
                        .home = &here,
                        .hops = hops,
                        .order = order,
                        .count = count};
    status = order ? search_all(&hunt) : GD_NO_MEMORY;
    free(order);
    return status ? gd_fail(detail, status, "%s", gd_status_sentence(status)) : GD_OK;
}
