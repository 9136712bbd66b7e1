#include "field/ridges.h"
#include "mesh/union_find.h"

/* Branches of the graph of ridges. A branch is a chain of parts between two nodes. At each of these
 * two nodes, either a single part ends, or at least three parts meet. A branch is dropped if its
 * greatest angle is below `min_angle`. */

/* Scratch: an entry for each part. */
struct work {
    uint32_t *parent; /* a forest of the parts of each branch */
    bool *keep;
};

/* --- branches --------------------------------------------------------------------------------- */

/* Sets `keep` for the parts of the branches that have a sufficient angle. */
static void mark_branches(struct gd__ridges *ridges, const struct work *work)
{
    const struct gd__diagram *diagram = &ridges->diagram;
    struct gd__pace *pace = &ridges->pace;
    uint32_t parts = diagram->bisector_part_count, *parent = work->parent;
    GD__PACED (pace, i, parts) parent[i] = i;
    GD__PACED (pace, i, diagram->node_count) {
        const struct gd__node *node = &diagram->node[i];
        if (node->is_end || node->bisector_part[1] == GD_NONE) continue;
        gd__union_find_join(parent, node->bisector_part[0], node->bisector_part[1]);
    }
    GD__PACED (pace, i, parts) work->keep[i] = false;
    GD__PACED (pace, i, parts) {
        if (ridges->pair[i].angle >= ridges->min_angle)
            work->keep[gd__union_find_root(parent, i)] = true;
    }
    GD__PACED (pace, i, parts) {
        work->keep[i] = work->keep[gd__union_find_root(parent, i)] &&
                        !gd__ridge_is_point(&diagram->bisector_part[i]);
    }
}

/* --- removal ---------------------------------------------------------------------------------- */

/* Removes the parts for which `keep` is false, and renumbers the others. */
static void keep_parts(struct gd__ridges *ridges, const bool *keep)
{
    struct gd__diagram *diagram = &ridges->diagram;
    uint32_t kept = 0;
    GD__PACED (&ridges->pace, i, diagram->bisector_part_count) {
        if (keep[i]) diagram->bisector_part[kept++] = diagram->bisector_part[i];
    }
    diagram->bisector_part_count = kept;
}

/* Marks a node as an end of lines if its two parts have different members. */
static void end_at_members(struct gd__ridges *ridges)
{
    struct gd__diagram *diagram = &ridges->diagram;
    GD__PACED (&ridges->pace, i, diagram->node_count) {
        struct gd__node *node = &diagram->node[i];
        if (node->bisector_part[1] == GD_NONE) continue;
        const uint32_t *a = diagram->bisector_part[node->bisector_part[0]].member,
                       *b = diagram->bisector_part[node->bisector_part[1]].member;
        node->is_end |= a[0] != b[0] || a[1] != b[1];
    }
}

enum gd_status gd__ridges_keep_branches(struct gd__ridges *ridges)
{
    struct gd__arena *arena = &ridges->diagram.arena;
    size_t parts = ridges->diagram.bisector_part_count;
    const struct work work = {gd__arena_take(arena, parts, sizeof *work.parent),
                              gd__arena_take(arena, parts, sizeof *work.keep)};
    if (arena->status) return arena->status;
    mark_branches(ridges, &work);
    keep_parts(ridges, work.keep);
    gd__ridges_count(ridges);
    end_at_members(ridges);
    return ridges->pace.status;
}
