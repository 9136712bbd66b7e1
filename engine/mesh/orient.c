/* A consistent orientation: neighbours run along their common edge in opposite directions. Breadth first over each
 * component, from its lowest-numbered face; the majority of a component's faces keeps the orientation of the input,
 * at a tie that face does. */
#include <stdlib.h>
#include <string.h>

#include "mesh/build.h"
#include "mesh/offenders.h"

struct search {
    uint32_t *queue; /* all faces, component by component */
    uint32_t end;
    struct gd__offenders contradictions; /* a, b: an edge; witness: a face of its component */
};

static bool run_alike(const struct gd__construction *work, uint32_t side, uint32_t other)
{
    return work->corner[side / 3][side % 3] == work->corner[other / 3][other % 3];
}

static void note_contradiction(struct gd__construction *work, uint32_t side, struct search *search)
{
    const struct gd_mesh *mesh = work->mesh;
    const uint32_t *corner = work->corner[side / 3];
    uint32_t a = mesh->index_of_vertex[corner[side % 3]];
    uint32_t b = mesh->index_of_vertex[corner[gd__next_corner(side % 3)]];
    gd__offenders_add(&search->contradictions, a < b ? a : b, a < b ? b : a, gd__input_polygon(mesh, side / 3));
}

static void visit_neighbours(struct gd__construction *work, uint32_t face, struct search *search, bool *contradicted)
{
    uint8_t *flipped = work->mesh->face_flipped;
    for (uint32_t side = 3 * face; side < 3 * face + 3; side++) {
        uint32_t other = work->neighbour[side];
        if (other == GD_NONE) continue;
        uint8_t wanted = flipped[face] ^ (uint8_t)run_alike(work, side, other);
        if (work->component[other / 3] == GD_NONE) {
            work->component[other / 3] = work->component[face];
            flipped[other / 3] = wanted;
            search->queue[search->end++] = other / 3;
        } else if (flipped[other / 3] != wanted && !*contradicted) {
            note_contradiction(work, side, search);
            *contradicted = true;
        }
    }
}

/* Lets the majority of queue[begin, end) keep its orientation; returns how many are turned over. */
static uint32_t side_with_majority(uint8_t *flipped, const uint32_t *queue, uint32_t begin, uint32_t end)
{
    uint32_t turned = 0, count = end - begin;
    for (uint32_t i = begin; i < end; i++) turned += flipped[queue[i]];
    if (2 * (uint64_t)turned <= count) return turned;
    for (uint32_t i = begin; i < end; i++) flipped[queue[i]] ^= 1;
    return count - turned;
}

static void orient_component(struct gd__construction *work, uint32_t seed, struct search *search)
{
    uint32_t begin = search->end;
    bool contradicted = false;
    work->component[seed] = work->component_count++;
    search->queue[search->end++] = seed;
    for (uint32_t i = begin; i < search->end; i++) visit_neighbours(work, search->queue[i], search, &contradicted);
    work->mesh->summary.flipped_faces +=
        side_with_majority(work->mesh->face_flipped, search->queue, begin, search->end);
}

static uint32_t side_after_flips(const struct gd_mesh *mesh, uint32_t side)
{
    if (side == GD_NONE || !mesh->face_flipped[side / 3]) return side;
    return side - side % 3 + (2 - side % 3);
}

/* Swaps corners 1 and 2 of the flipped faces: their side k becomes side 2 - k. */
static void turn_over(struct gd__construction *work)
{
    for (uint32_t f = 0; f < work->mesh->face_count; f++) {
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

static enum gd_status refuse(const struct gd__construction *work, const struct gd__offenders *contradictions)
{
    const struct gd__offender *edge = &contradictions->lowest[0];
    gd_fail(work->detail, GD_NON_ORIENTABLE,
            "the component of face %u is one-sided, like a Moebius strip: its orientation disagrees at edge %u-%u "
            "whichever way "
            "faces are turned",
            edge->witness, (unsigned)edge->a, (unsigned)edge->b);
    return gd__offenders_report(contradictions, GD_ELEMENT_EDGE, GD_NON_ORIENTABLE, work->detail);
}

enum gd_status gd__orient(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct search search = {.queue = malloc(mesh->face_count * sizeof *search.queue)};
    work->component = malloc(mesh->face_count * sizeof *work->component);
    mesh->face_flipped = gd__mesh_array(mesh, mesh->face_count, sizeof *mesh->face_flipped);
    if (!search.queue || !work->component || !mesh->face_flipped) {
        free(search.queue);
        return GD_NO_MEMORY;
    }
    memset(work->component, 0xff, mesh->face_count * sizeof *work->component);
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        uint32_t seed = mesh->face_of_index[i];
        if (work->component[seed] == GD_NONE) orient_component(work, seed, &search);
    }
    free(search.queue);
    if (search.contradictions.total) return refuse(work, &search.contradictions);
    turn_over(work);
    return GD_OK;
}
