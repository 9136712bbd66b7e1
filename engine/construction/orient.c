/* Makes the orientation of the whole mesh consistent. Rejects non-orientable components. */
#include <stdlib.h>

#include "construction/steps.h"
#include "construction/offenders.h"
#include "mesh/orientation.h"

struct contradictions {
    const struct gd__construction *work;
    struct gd__offenders edges; /* (`a`, `b`) is an edge, `witness` a face of its component */
};

static void note_contradiction(void *user, uint32_t side)
{
    struct contradictions *contradictions = user;
    const struct gd_mesh *mesh = contradictions->work->mesh;
    const uint32_t *corner = contradictions->work->corner[side / 3];
    uint32_t a = mesh->index_of_vertex[corner[side % 3]];
    uint32_t b = mesh->index_of_vertex[corner[gd__next_corner(side % 3)]];
    gd__offenders_add(&contradictions->edges, a < b ? a : b, a < b ? b : a,
                      gd__input_polygon(mesh, side / 3));
}

static uint32_t side_after_flips(const struct gd_mesh *mesh, uint32_t side)
{
    if (side == GD_NONE || !mesh->face_flipped[side / 3]) return side;
    return side - side % 3 + (2 - side % 3);
}

/* Swaps corners 1 and 2 of the flipped faces. Side k of such a face becomes side 2 - k. */
static void turn_over(struct gd__construction *work)
{
    GD__PACED (&work->pace, f, work->mesh->face_count) {
        uint32_t *corner = work->corner[f], *neighbour = work->neighbour + 3 * (size_t)f;
        for (int k = 0; k < 3; k++) neighbour[k] = side_after_flips(work->mesh, neighbour[k]);
        if (!work->mesh->face_flipped[f]) continue;
        uint32_t kept_corner = corner[1], kept_neighbour = neighbour[0];
        corner[1] = corner[2];
        corner[2] = kept_corner;
        neighbour[0] = neighbour[2];
        neighbour[2] = kept_neighbour;
    }
}

static enum gd_status orient_refuse(const struct gd__construction *work,
                                    const struct gd__offenders *contradictions)
{
    const struct gd__offender *edge = &contradictions->lowest[0];
    gd_fail(work->detail, GD_NON_ORIENTABLE,
            "the component of face %u is one-sided, like a Moebius strip: its orientation "
            "disagrees at edge %u-%u "
            "whichever way "
            "faces are turned",
            edge->witness, (unsigned)edge->a, (unsigned)edge->b);
    return gd__offenders_report(contradictions, GD_ELEMENT_EDGE, GD_NON_ORIENTABLE, work->detail);
}

enum gd_status gd__orient(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    work->component =
        gd__scratch_array(work, &work->until_fans, mesh->face_count, sizeof *work->component);
    mesh->face_flipped = gd__mesh_array(work, mesh->face_count, sizeof *mesh->face_flipped);
    if (!work->component || !mesh->face_flipped) return GD_NO_MEMORY;
    struct contradictions contradictions = {.work = work};
    struct gd__orientation orientation = {
        .corner = (const uint32_t(*)[3])work->corner,
        .neighbour = work->neighbour,
        .face_count = mesh->face_count,
        .seeds = mesh->face_of_index,
        .seed_count = mesh->summary.face_index_count,
        .contradicted = note_contradiction,
        .user = &contradictions,
        .pace = &work->pace,
        .flipped = mesh->face_flipped,
        .component = work->component,
    };
    enum gd_status status = gd__orient_faces(&orientation);
    if (status) return status;
    if (contradictions.edges.total) return orient_refuse(work, &contradictions.edges);
    work->component_count = orientation.component_count;
    mesh->summary.flipped_faces = orientation.flipped_count;
    turn_over(work);
    return GD_OK;
}
