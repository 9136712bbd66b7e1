/* Applies several edits. Each edit works on the result of the previous one. */
#include <stdlib.h>

#include "base/pace.h"
#include "base/share.h"
#include "edit/edited.h"
#include "gd/locate.h"

struct chain {
    const struct gd_mesh *original;
    /* the mesh for the next step, as a counted reference; before the first rebuild, the original
       mesh */
    const struct gd_mesh *mesh;
    struct gd_edited made; /* result of the steps so far, empty before the first step */
    /* number of faces of `made` that are certainly faces of the original mesh; they come first */
    uint32_t kept;
    struct gd__share share;
};

static enum gd_status run_step(struct chain *chain, const struct gd_edit_step *step,
                               struct gd_edited *out, struct gd_detail *detail)
{
    struct gd_control control = gd__share_control(&chain->share, chain->made.bytes);
    switch (step->kind) {
    case GD_EDIT_SIMPLIFY:
        return gd_simplify(chain->mesh, &step->simplify, &control, out, detail);
    case GD_EDIT_COMPONENTS:
        return gd_components(chain->mesh, &step->components, &control, out, detail);
    case GD_EDIT_SUBDIVIDE:
        return gd__subdivide_once(chain->mesh, &step->subdivide, &control, out, detail);
    case GD_EDIT_SMOOTH:
        return gd_smooth_mesh(chain->mesh, &step->smooth, &control, out, detail);
    case GD_EDIT_FILL:
        return gd_fill(chain->mesh, &step->fill, &control, out, detail);
    }
    return gd_fail(detail, GD_INVALID_ARGUMENT, "there is no edit of kind %d", (int)step->kind);
}

/* Converts a position on the mesh of the current step to an origin on the original mesh. */
static enum gd_status origin_before(const struct chain *chain, struct gd_vec3 place,
                                    struct gd_origin *origin)
{
    const struct gd_polygons *before = &chain->made.polygons;
    struct gd_point nearest;
    for (int k = 0; k < 3; k++) {
        if (origin->barycentric[k] == 1) {
            *origin = chain->made.origins[before->corners[3 * origin->face + (uint32_t)k]];
            return GD_OK;
        }
    }
    enum gd_status status = gd_locate_nearest(chain->original, place, -1, &nearest, NULL);
    if (!status) *origin = gd__origin_of(chain->original, &nearest);
    return status;
}

static enum gd_status trace_origins(struct chain *chain, struct gd_edited *made)
{
    struct gd__pace pace = {.control = chain->share.control,
                            .fraction = chain->share.done / (double)chain->share.total};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; !status && i < made->polygons.position_count && gd__pace(&pace, 40); i++) {
        const double *p = made->polygons.positions[i];
        status = origin_before(chain, (struct gd_vec3){p[0], p[1], p[2]}, &made->origins[i]);
    }
    return status ? status : pace.status;
}

/* Builds the mesh for the next step from the result of the steps so far. */
static enum gd_status rebuild(struct chain *chain, struct gd_detail *detail)
{
    struct gd_control control = gd__share_control(&chain->share, chain->made.bytes);
    struct gd_mesh *mesh;
    enum gd_status status = gd_mesh_build(&chain->made.polygons, NULL, &control, &mesh, detail);
    if (status) return status;
    gd_mesh_release(chain->mesh);
    chain->mesh = mesh;
    return GD_OK;
}

/* Returns the number of first faces of a step's result that are faces of the original mesh. */
static uint32_t kept_after(const struct chain *chain, const struct gd_edit_step *step,
                           const struct gd_edited *made)
{
    bool has_kept_all = chain->kept == gd__edit_counts(chain->mesh).faces;
    if (has_kept_all && step->kind == GD_EDIT_COMPONENTS) return made->polygons.polygon_count;
    return has_kept_all && step->kind == GD_EDIT_FILL ? chain->kept : 0;
}

/* Returns the number of rounds of a step: each level of a subdivision is a round. */
static uint32_t rounds(const struct gd_edit_step *step)
{
    return step->kind == GD_EDIT_SUBDIVIDE ? step->subdivide.levels : 1;
}

static enum gd_status chain_step(struct chain *chain, const struct gd_edit_step *step,
                                 struct gd_detail *detail)
{
    bool is_first = chain->share.done == 0;
    struct gd_edited made = {0};
    enum gd_status status = is_first ? GD_OK : rebuild(chain, detail);
    chain->share.done++;
    if (!status) status = run_step(chain, step, &made, detail);
    chain->share.done++;
    if (!status && !is_first) status = trace_origins(chain, &made);
    if (status) {
        gd_edited_free(&made);
        return status;
    }
    chain->kept = kept_after(chain, step, &made);
    gd_edited_free(&chain->made);
    chain->made = made;
    return GD_OK;
}

static enum gd_status chain_run(struct chain *chain, const struct gd_edit_steps *steps,
                                struct gd_detail *detail)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; !status && i < steps->count; i++) {
        const struct gd_edit_step *step = &steps->items[i];
        if (steps->failed) *steps->failed = i;
        for (uint32_t k = 0; !status && k < rounds(step); k++)
            status = chain_step(chain, step, detail);
    }
    /* gd_simplify has already measured the distance */
    if (status || (steps->count == 1 && steps->items->kind == GD_EDIT_SIMPLIFY)) return status;
    struct gd_control control = gd__share_control(&chain->share, chain->made.bytes);
    return gd__edited_measure(&chain->made, chain->original, chain->kept, &control, detail);
}

static enum gd_status check_steps(const struct gd_edit_step *steps, uint32_t count, uint32_t *total,
                                  struct gd_detail *detail)
{
    if (count == 0 || count > GD_EDIT_STEPS_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "give 1 to %d steps, not %u",
                       GD_EDIT_STEPS_MOST, count);
    *total = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t levels = rounds(&steps[i]);
        if (levels < 1 || levels > GD_SUBDIVIDE_LEVELS_MOST)
            return gd_fail(detail, GD_INVALID_ARGUMENT, "levels = %u is not 1 to %d", levels,
                           GD_SUBDIVIDE_LEVELS_MOST);
        *total += levels;
    }
    return GD_OK;
}

enum gd_status gd_edit_apply(const struct gd_mesh *mesh, const struct gd_edit_steps *steps,
                             const struct gd_control *control, struct gd_edited *out,
                             struct gd_detail *detail)
{
    struct chain chain = {.original = mesh, .share = {.control = control}};
    uint32_t total = 0;
    enum gd_status status = check_steps(steps->items, steps->count, &total, detail);
    if (status) return status;
    chain.share.total = 2 * total + 1;
    chain.mesh = gd_mesh_retain(mesh);
    chain.kept = gd__edit_counts(mesh).faces;
    status = chain_run(&chain, steps, detail);
    gd_mesh_release(chain.mesh);
    if (status)
        gd_edited_free(&chain.made);
    else
        *out = chain.made;
    return status;
}
