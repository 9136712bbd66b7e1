#include "query/search.h"

#include <stdlib.h>

#include "base/share.h"
#include "field/arrivals.h"
#include "query/landmarks.h"

/* A shortest path in a graph bounds the distance from above (wedge/guide.h). Windows are propagated in the surroundings of that path first, where they
 * find, mostly, the distance itself; with that bound they are propagated everywhere, which leaves little to do: a window goes on only if the way
 * through it, and on by the lower bounds of its edge's ends, can be as short (Xin and Wang 2009; Qin et al. 2016 prune fields, not pairs). */

struct search {
    const struct gd_mesh *mesh;
    struct gd__seed seed;
    const struct gd_point *target;
    enum gd_pair_wish wish;
    struct gd_pair_answer *out;
    double distance; /* of the last run, inside unit */
};

/* The wavefront's arrays as a field; they stay the workspace's. */
static enum gd_status view(const struct search *search, const struct gd_workspace *work, struct gd_field *field)
{
    *field = (struct gd_field){.mesh = search->mesh,
                               .reach = GD__FAR,
                               .distance = work->distance,
                               .birth = work->birth,
                               .newest = work->newest,
                               .wedges = work->wedges.base,
                               .wedge_bytes = work->wedges.used,
                               .seeds = (struct gd__seed *)&search->seed,
                               .seed_count = 1};
    return gd__field_index_seeds(field);
}

/* A sink that keeps nothing: reads the distance, and the path of the last run. */
static enum gd_status answer(void *user, struct gd__wavefront *front, const struct gd_executor *executor)
{
    (void)executor;
    struct search *search = user;
    struct gd_field field;
    enum gd_status status = view(search, front->work, &field);
    if (status) return status;
    search->distance = gd__field_leg(&field, search->target).distance;
    if (search->out && search->wish) status = gd_field_path(&field, search->target, &search->out->path);
    if (search->out && search->wish == GD_PAIR_PATH_AND_CUT && !status)
        status = gd__field_path_is_cut(&field, &search->out->path, &search->out->is_cut);
    free(field.face_seeds);
    return status;
}

static enum gd_status run(struct search *search, struct gd__guide *guide, double bound, struct gd_pair_answer *out,
                          const struct gd_control *control)
{
    struct gd__propagation propagation = {.seeds = &search->seed, .seed_count = 1, .radius = bound, .guide = guide};
    struct gd__sink sink = {.take = answer, .user = search};
    search->out = out;
    return gd__wavefront_run(search->mesh, &propagation, &sink, control, NULL);
}

/* In the corridor, then everywhere: most of the time goes to the second run. */
static enum gd_status run_both(struct search *search, struct gd__guide *guide, double upper, struct gd_pair_answer *out,
                               const struct gd_control *control)
{
    struct gd__share share = {.control = control, .total = 2};
    enum gd_status status = gd__guide_mark_corridor(guide, &search->seed.point);
    struct gd_control own = gd__share_control(&share, gd__guide_held(guide));
    double rounding = guide->margin + GD_TOL_PLACE * (search->mesh->summary.edge_length.max / search->mesh->unit);
    upper += rounding; /* between points close together it is more than a part of their distance */
    guide->in_corridor_only = true;
    if (!status) status = run(search, guide, upper, NULL, &own);
    guide->in_corridor_only = false;
    share.done = 1;
    upper = fmin(upper, search->distance * (1 + GD_TOL_BOUND) + rounding);
    if (!status) status = run(search, guide, upper, out, &own);
    if (!status && !(search->distance <= upper * (1 + GD_TOL_CHECK))) status = GD_INTERNAL; /* lost on the way */
    if (!status) out->distance = search->distance * search->mesh->unit;
    return status;
}

static enum gd_status search_in(struct gd_workspace *work, struct search *search, const struct gd_landmarks *landmarks,
                                const struct gd_control *control, struct gd_pair_answer *out)
{
    struct gd__guide *guide = &work->guide;
    double upper;
    gd__landmarks_offer(landmarks, search->mesh, guide);
    enum gd_status status = gd__guide_aim(guide, search->mesh, &search->seed.point, search->target, control, &upper);
    if (!status) status = run_both(search, guide, upper, out, control);
    gd__guide_clean(guide);
    return status;
}

enum gd_status gd__search(const struct gd_mesh *mesh, const struct gd_point *from, const struct gd_point *to,
                          enum gd_pair_wish wish, const struct gd_landmarks *landmarks,
                          const struct gd_control *control, struct gd_pair_answer *out)
{
    if (gd_point_component(mesh, from) != gd_point_component(mesh, to)) {
        out->distance = INFINITY;
        return GD_OK;
    }
    struct search search = {.mesh = mesh, .seed = {.point = *from}, .target = to, .wish = wish};
    struct gd_control own = control ? *control : (struct gd_control){0};
    if (!own.workspace) own.workspace = gd_workspace_create();
    if (!own.workspace) return GD_NO_MEMORY;
    enum gd_status status = search_in(own.workspace, &search, landmarks, &own, out);
    if (!control || !control->workspace) gd_workspace_destroy(own.workspace);
    return status;
}
