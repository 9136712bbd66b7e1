#include "gd/cut.h"

#include "base/share.h"
#include "base/tolerance.h"
#include "cut/pieces.h"
#include "line/turn.h"

/* --- the curve -------------------------------------------------------------------------------- */

/* Rejects an open curve whose ends are not on the boundary, unless both ends are the same point. */
static enum gd_status check_ends(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                 struct gd_detail *detail)
{
    const struct gd_point *first = &curve->points[0], *last = &curve->points[curve->count - 1];
    if (curve->closed || (curve->count > 1 && gd_point_equal(first, last))) return GD_OK;
    bool is_first = gd__turn_is_closed(mesh, first);
    if (!is_first && !gd__turn_is_closed(mesh, last)) return GD_OK;
    return gd_fail(detail, GD_INVALID_ARGUMENT,
                   "the %s point of the open curve is not on a boundary; close the curve, or move "
                   "both ends to boundary edges",
                   is_first ? "first" : "last");
}

/* --- attempts --------------------------------------------------------------------------------- */

/* One attempt to refine the mesh, with one snap distance. `refined` borrows from `arrangement`. */
struct attempt {
    struct gd__arrangement arrangement;
    struct gd__seam seam;
    struct gd__refined refined;
    uint32_t flat_face;
};

static void cut_clear(struct attempt *attempt)
{
    gd__refined_free(&attempt->refined);
    gd__seam_free(&attempt->seam);
    gd__arrangement_free(&attempt->arrangement);
    attempt->flat_face = GD_NONE;
}

static enum gd_status try(struct attempt *attempt, const struct gd_mesh *mesh,
                          const struct gd_curve *curve, double snap, struct gd__budget *budget,
                          struct gd_detail *detail)
{
    cut_clear(attempt);
    budget->held = 0;
    enum gd_status status = gd__arrange(mesh, curve, snap, budget, &attempt->arrangement, detail);
    if (!status) status = gd__seam_make(&attempt->arrangement, &attempt->seam);
    if (!status && attempt->seam.cuts == 0)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the curve cuts nothing, because it encloses no area or follows the "
                       "boundary; choose another curve");
    return status ? status
                  : gd__refine(&attempt->arrangement, &attempt->seam, &attempt->refined,
                               &attempt->flat_face);
}

/* Tries increasing snap distances until an attempt succeeds. */
static enum gd_status try_snaps(struct attempt *attempt, const struct gd_mesh *mesh,
                                const struct gd_curve *curve, struct gd__budget *budget,
                                struct gd_detail *detail)
{
    enum gd_status status = GD_RUNAWAY;
    for (double snap = GD_TOL_SEAM; snap < GD_TOL_SEAM_MOST && status == GD_RUNAWAY;
         snap *= GD_TOL_SEAM_STEP)
        status = try(attempt, mesh, curve, snap, budget, detail);
    if (status != GD_RUNAWAY) return status;
    if (attempt->flat_face == GD_NONE)
        return gd_fail(detail, GD_TOO_LARGE,
                       "the curve crosses itself too often; cut along several simpler curves, one "
                       "after the other");
    return gd_fail(detail, GD_INVALID_ARGUMENT,
                   "the curve cuts the sliver face %u into pieces whose area is too small; avoid "
                   "that face, or upload the mesh with repair=split",
                   mesh->index_of_face[attempt->flat_face]);
}

enum gd_status gd_cut_along(const struct gd_mesh *mesh, const struct gd_cut_request *request,
                            const struct gd_control *control, struct gd_cut *out,
                            struct gd_detail *detail)
{
    struct gd__share attempts = {.control = control, .total = 1};
    const struct gd_control own = gd__share_control(&attempts, 0);
    struct gd__budget budget = {.control = &own};
    struct attempt attempt = {0};
    struct gd_cut cut = {0};
    enum gd_status status = check_ends(mesh, request->curve, detail);
    if (!status) status = try_snaps(&attempt, mesh, request->curve, &budget, detail);
    double shift = attempt.arrangement.nodes.shift * mesh->unit;
    if (!status) status = gd__pieces_make(&attempt.refined, request, &budget, &cut, detail);
    cut_clear(&attempt);
    if (status) return status;
    *out = cut;
    out->largest_shift = shift;
    return GD_OK;
}
