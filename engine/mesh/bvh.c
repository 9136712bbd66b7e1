#include "mesh/bvh.h"

#include <stdlib.h>

#include "base/slices.h"
#include "mesh/construction.h"
#include "mesh/closest_point.h"

/* Plain comparisons suffice because no coordinate is NaN. They are single instructions, whereas
 * fmin and fmax are calls. */
static struct gd_vec3 lower(struct gd_vec3 a, struct gd_vec3 b)
{
    return (struct gd_vec3){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}

static struct gd_vec3 upper(struct gd_vec3 a, struct gd_vec3 b)
{
    return (struct gd_vec3){a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

static struct gd__box bvh_join(struct gd__box a, struct gd__box b)
{
    return (struct gd__box){lower(a.min, b.min), upper(a.max, b.max)};
}

static struct gd__box box_of_face(const struct gd_mesh *mesh, uint32_t face)
{
    const uint32_t *side = mesh->face_side[face];
    struct gd_vec3 a = mesh->position[mesh->origin[side[0]]],
                   b = mesh->position[mesh->origin[side[1]]];
    struct gd_vec3 c = mesh->position[mesh->origin[side[2]]];
    return (struct gd__box){lower(lower(a, b), c), upper(upper(a, b), c)};
}

static uint32_t parents(uint32_t children, uint32_t width)
{
    return (children + width - 1) / width;
}

/* Computes the levels. Returns the number of boxes. */
static uint32_t plan_levels(struct gd_bvh *bvh, uint32_t face_count)
{
    uint32_t total = 0;
    for (uint32_t count = parents(face_count, GD_BVH_LEAF);; count = parents(count, GD_BVH_WIDTH)) {
        bvh->level_first[bvh->levels] = total;
        bvh->level_count[bvh->levels++] = count;
        total += count;
        if (count == 1) return total;
    }
}

static void fill_leaves(void *context, struct gd__pace *pace, uint32_t first, uint32_t last)
{
    const struct gd_mesh *mesh = context;
    (void)pace;
    for (uint32_t i = first; i < last; i++) {
        uint32_t begin = i * GD_BVH_LEAF, end = begin + GD_BVH_LEAF;
        if (end > mesh->face_count) end = mesh->face_count;
        struct gd__box box = box_of_face(mesh, begin);
        for (uint32_t f = begin + 1; f < end; f++) box = bvh_join(box, box_of_face(mesh, f));
        mesh->bvh->box[i] = box;
    }
}

static void fill_level(struct gd__construction *work, uint32_t level)
{
    struct gd_bvh *bvh = work->mesh->bvh;
    const struct gd__box *below = bvh->box + bvh->level_first[level - 1];
    GD__PACED (&work->pace, i, bvh->level_count[level]) {
        uint32_t begin = i * GD_BVH_WIDTH, end = begin + GD_BVH_WIDTH;
        if (end > bvh->level_count[level - 1]) end = bvh->level_count[level - 1];
        struct gd__box *box = &bvh->box[bvh->level_first[level] + i];
        *box = below[begin];
        for (uint32_t c = begin + 1; c < end; c++) *box = bvh_join(*box, below[c]);
    }
}

enum gd_status gd__make_bvh(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    mesh->bvh = gd__mesh_array(work, 1, sizeof *mesh->bvh);
    if (!mesh->bvh) return GD_NO_MEMORY;
    uint32_t boxes = plan_levels(mesh->bvh, mesh->face_count);
    mesh->bvh->box = gd__mesh_array(work, boxes, sizeof *mesh->bvh->box);
    if (!mesh->bvh->box) return GD_NO_MEMORY;
    gd__slices_run(&work->pace, mesh->bvh->level_count[0], fill_leaves, mesh);
    for (uint32_t level = 1; level < mesh->bvh->levels; level++) fill_level(work, level);
    return GD_OK;
}

/* A box to be visited. */
struct pending {
    double bound;
    uint32_t level, index;
};

/* Stack of boxes to be visited. It holds at most GD_BVH_WIDTH boxes of each level at a time. */
struct agenda {
    struct pending entry[GD_BVH_MAX_LEVELS * GD_BVH_WIDTH];
    uint32_t count;
};

/* Pushes the children of `parent` that are within the limit onto the agenda, the nearest on top. */
static void push_children(const struct gd_bvh *bvh, const struct gd__bvh_search *search,
                          struct pending parent, struct agenda *agenda)
{
    uint32_t level = parent.level - 1, base = agenda->count;
    uint32_t begin = parent.index * GD_BVH_WIDTH, end = begin + GD_BVH_WIDTH;
    if (end > bvh->level_count[level]) end = bvh->level_count[level];
    for (uint32_t i = begin; i < end; i++) {
        double bound = search->bound(search, &bvh->box[bvh->level_first[level] + i]);
        if (!(bound < INFINITY) || bound > search->limit) continue;
        uint32_t at = agenda->count++;
        for (; at > base && agenda->entry[at - 1].bound < bound; at--)
            agenda->entry[at] = agenda->entry[at - 1];
        agenda->entry[at] = (struct pending){bound, level, i};
    }
}

static void visit_leaf(const struct gd_mesh *mesh, struct gd__bvh_search *search, uint32_t leaf)
{
    uint32_t begin = leaf * GD_BVH_LEAF, end = begin + GD_BVH_LEAF;
    if (end > mesh->face_count) end = mesh->face_count;
    for (uint32_t f = begin; f < end; f++) {
        struct gd__box box = box_of_face(mesh, f);
        if (search->bound(search, &box) <= search->limit) search->visit(search, f);
    }
}

void gd__bvh_run(const struct gd_mesh *mesh, struct gd__bvh_search *search)
{
    const struct gd_bvh *bvh = mesh->bvh;
    struct agenda agenda = {.count = 1};
    agenda.entry[0] = (struct pending){-INFINITY, bvh->levels - 1, 0};
    while (agenda.count) {
        struct pending top = agenda.entry[--agenda.count];
        if (top.bound > search->limit) continue;
        if (top.level)
            push_children(bvh, search, top, &agenda);
        else
            visit_leaf(mesh, search, top.index);
    }
}

double gd__bvh_magnitude(const struct gd_mesh *mesh)
{
    const struct gd__box *all = &mesh->bvh->box[mesh->bvh->level_first[mesh->bvh->levels - 1]];
    return fmax(gd__largest_coordinate(all->min), gd__largest_coordinate(all->max));
}

void gd__bvh_free(struct gd_bvh *bvh)
{
    if (!bvh) return;
    free(bvh->box);
    free(bvh);
}
