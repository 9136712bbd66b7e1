#include <stdlib.h>

#include "base/array.h"
#include "field/ridges.h"

/* The graph of ridges. Ends of parts meet at nodes. A branch is a chain of parts between two nodes
 * at which one part ends, or three or more meet. */

/* --- parts ------------------------------------------------------------------------------------ */

static enum gd_status add_part(struct gd__ridges *ridges, const struct gd__bisector_part *part,
                               double angle, uint32_t *out)
{
    enum gd_status status = gd__array_append(&ridges->angle, &ridges->angle_count,
                                             &ridges->angle_capacity, &angle, sizeof angle);
    return status ? status : gd__diagram_add_bisector_part(&ridges->diagram, part, out);
}

enum gd_status gd__ridges_add(struct gd__ridges *ridges, const struct gd__ridge *ridge)
{
    uint32_t number;
    enum gd_status status = add_part(ridges, &ridge->part, ridge->angle, &number);
    for (uint32_t k = 0; k < 2 && !status; k++) {
        struct gd__ridge_end end = ridge->end[k];
        end.part = number;
        end.end = k;
        status = gd__array_append(&ridges->end, &ridges->end_count, &ridges->end_capacity, &end,
                                  sizeof end);
    }
    return status;
}

/* --- parts along edges ------------------------------------------------------------------------ */

static double place_on_edge(const struct gd_mesh *mesh, uint32_t edge,
                            const struct gd__ridge_end *end)
{
    if (end->kind == GD_POINT_EDGE) return end->at.x;
    return end->element == mesh->origin[2 * edge] ? 0 : mesh->side[2 * edge].length;
}

enum gd_status gd__ridges_add_along(struct gd__ridges *ridges, uint32_t edge,
                                    const struct gd__ridge *ridge)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    double a = place_on_edge(mesh, edge, &ridge->end[0]),
           b = place_on_edge(mesh, edge, &ridge->end[1]);
    const struct gd__along along = {.edge = edge,
                                    .face = ridge->part.face,
                                    .member = {ridge->part.member[0], ridge->part.member[1]},
                                    .from = fmin(a, b),
                                    .to = fmax(a, b),
                                    .angle = ridge->angle,
                                    .near = ridge->end[0].near};
    return gd__array_append(&ridges->along, &ridges->along_count, &ridges->along_capacity, &along,
                            sizeof along);
}

static int by_interval(const void *a, const void *b)
{
    const struct gd__along *x = a, *y = b;
    if (x->edge != y->edge) return x->edge < y->edge ? -1 : 1;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    if (x->to != y->to) return x->to > y->to ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

static struct gd__ridge_end end_on_edge(const struct gd_mesh *mesh, const struct gd__along *along,
                                        double t)
{
    double length = mesh->side[2 * along->edge].length;
    struct gd__ridge_end end = {.kind = GD_POINT_VERTEX, .near = along->near};
    if (t > 0 && t < length) {
        end.kind = GD_POINT_EDGE;
        end.element = along->edge;
        end.at.x = t;
        end.point = gd__point_of_edge(mesh, along->edge, t / length);
    } else {
        end.element = mesh->origin[2 * along->edge + (t > 0)];
        end.point = gd__point_of_vertex(end.element);
    }
    return end;
}

static enum gd_status add_interval(struct gd__ridges *ridges, const struct gd__along *along)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    const struct gd__ridge ridge = {
        .part = {.face = along->face,
                 .member = {along->member[0], along->member[1]},
                 .node = {GD_NONE, GD_NONE},
                 .is_straight = true},
        .angle = along->angle,
        .end = {end_on_edge(mesh, along, along->from), end_on_edge(mesh, along, along->to)}};
    return along->to - along->from > along->near ? gd__ridges_add(ridges, &ridge) : GD_OK;
}

/* Adds the parts along edges as disjoint intervals. Overlapping intervals of the same members are
 * joined. */
static enum gd_status add_intervals(struct gd__ridges *ridges)
{
    enum gd_status status = GD_OK;
    ridges->first_along = ridges->diagram.bisector_part_count;
    if (ridges->along_count)
        qsort(ridges->along, ridges->along_count, sizeof *ridges->along, by_interval);
    for (uint32_t i = 0, next; i < ridges->along_count && !status; i = next) {
        struct gd__along *along = &ridges->along[i];
        for (next = i + 1; next < ridges->along_count; next++) {
            struct gd__along *other = &ridges->along[next];
            if (other->edge != along->edge) break;
            bool is_same =
                other->member[0] == along->member[0] && other->member[1] == along->member[1];
            if (other->from > along->to - along->near) break;
            if (!is_same && other->to > along->to) {
                other->from = along->to;
                break;
            }
            along->to = fmax(along->to, other->to);
            along->angle = fmax(along->angle, other->angle);
        }
        status = add_interval(ridges, along);
    }
    return status;
}

/* --- nodes ------------------------------------------------------------------------------------ */

static int by_place(const void *a, const void *b)
{
    const struct gd__ridge_end *x = a, *y = b;
    if (x->kind != y->kind) return x->kind < y->kind ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    if (x->at.x != y->at.x) return x->at.x < y->at.x ? -1 : 1;
    if (x->part != y->part) return x->part < y->part ? -1 : 1;
    return (x->end > y->end) - (x->end < y->end);
}

static double apart(const struct gd__ridge_end *a, const struct gd__ridge_end *b)
{
    return gd__local_length(gd__local_minus(a->at, b->at));
}

static uint32_t *node_of(const struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    return &ridges->diagram.bisector_part[end->part].node[end->end];
}

/* Gives an end the node of an earlier end at the same place, or a new node. `first`: the first end
 * on the same element. */
static enum gd_status give_node(struct gd__ridges *ridges, uint32_t first, uint32_t i)
{
    const struct gd__ridge_end *end = &ridges->end[i];
    for (uint32_t k = i; k-- > first && end->at.x - ridges->end[k].at.x <= end->near;) {
        const struct gd__ridge_end *other = &ridges->end[k];
        if (apart(end, other) > end->near) continue;
        *node_of(ridges, end) = *node_of(ridges, other);
        return GD_OK;
    }
    return gd__diagram_add_node(&ridges->diagram, &end->point, node_of(ridges, end));
}

static void count_end(struct gd__diagram *diagram, uint32_t number, uint32_t end)
{
    struct gd__node *node = &diagram->node[diagram->bisector_part[number].node[end]];
    if (node->bisector_part[0] == GD_NONE)
        node->bisector_part[0] = number;
    else if (node->bisector_part[1] == GD_NONE)
        node->bisector_part[1] = number;
    else
        node->is_end = true;
}

static void count_part(struct gd__diagram *diagram, uint32_t number)
{
    for (uint32_t k = 0; k < 2; k++) count_end(diagram, number, k);
}

/* Returns true for a part whose ends are one node. Such a part is not longer than rounding, or it
 * was dropped. */
static bool is_point(const struct gd__bisector_part *part)
{
    return part->node[0] == part->node[1];
}

static void count_parts(struct gd__diagram *diagram)
{
    for (uint32_t i = 0; i < diagram->node_count; i++) {
        diagram->node[i].is_end = false;
        diagram->node[i].bisector_part[0] = diagram->node[i].bisector_part[1] = GD_NONE;
    }
    for (uint32_t i = 0; i < diagram->bisector_part_count; i++)
        if (!is_point(&diagram->bisector_part[i])) count_part(diagram, i);
}

/* Returns true if no other part ends at the node of an end. */
static bool is_loose(const struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    const struct gd__diagram *diagram = &ridges->diagram;
    return !is_point(&diagram->bisector_part[end->part]) &&
           diagram->node[*node_of(ridges, end)].bisector_part[1] == GD_NONE;
}

static enum gd_status give_nodes(struct gd__ridges *ridges)
{
    struct gd__ridge_end *end = ridges->end;
    enum gd_status status = GD_OK;
    for (uint32_t first = 0, i = 0; i < ridges->end_count && !status; i++) {
        if (end[i].kind != end[first].kind || end[i].element != end[first].element) first = i;
        status = give_node(ridges, first, i);
    }
    return status;
}

/* --- gaps ------------------------------------------------------------------------------------- */

/* A node near a loose end, in a face that contains both. */
struct neighbour {
    uint32_t node, face;
    double apart;
};

static struct gd__local place_in(const struct gd_mesh *mesh, uint32_t face,
                                 const struct gd_point *point)
{
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    return gd__face_local(mesh, mesh->face_side[face][0], weight);
}

/* Returns the first end of the sorted list that lies on this element or on a later one. */
static uint32_t first_on(const struct gd__ridges *ridges, enum gd_point_kind kind, uint32_t element)
{
    uint32_t from = 0, to = ridges->end_count;
    while (from < to) {
        uint32_t middle = from + (to - from) / 2;
        const struct gd__ridge_end *end = &ridges->end[middle];
        bool is_before = end->kind != kind ? end->kind < kind : end->element < element;
        if (is_before)
            from = middle + 1;
        else
            to = middle;
    }
    return from;
}

/* Searches the ends on one element of a face. If one is nearer than `best`, replaces `best` by its
 * node. */
static void look_on(const struct gd__ridges *ridges, uint32_t loose, uint32_t face,
                    enum gd_point_kind kind, uint32_t element, struct neighbour *best)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    const struct gd__ridge_end *end = &ridges->end[loose];
    struct gd__local at = place_in(mesh, face, &end->point);
    for (uint32_t i = first_on(ridges, kind, element); i < ridges->end_count; i++) {
        const struct gd__ridge_end *other = &ridges->end[i];
        if (other->kind != kind || other->element != element) break;
        uint32_t node = *node_of(ridges, other);
        if (node == *node_of(ridges, end) || other->part == end->part) continue;
        double away = gd__local_length(gd__local_minus(place_in(mesh, face, &other->point), at));
        if (away < best->apart) *best = (struct neighbour){node, face, away};
    }
}

static void look_in_face(const struct gd__ridges *ridges, uint32_t loose, uint32_t face,
                         struct neighbour *best)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    if (face == GD_NONE) return;
    look_on(ridges, loose, face, GD_POINT_FACE, face, best);
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k];
        look_on(ridges, loose, face, GD_POINT_EDGE, side >> 1, best);
        look_on(ridges, loose, face, GD_POINT_VERTEX, mesh->origin[side], best);
    }
}

/* Returns the size of a part's face. */
static double size_at(const struct gd__ridges *ridges, uint32_t part)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    uint32_t face = ridges->diagram.bisector_part[part].face;
    const struct gd_side *side = &mesh->side[mesh->face_side[face][0]];
    return fmax(side->length, fmax(side->left_length, side->right_length));
}

/* Returns the point seed at an end, where a ridge may begin: a joint of a curve. NULL: none. */
static const struct gd__seed *seed_at(const struct gd__ridges *ridges,
                                      const struct gd__ridge_end *end)
{
    const struct gd_field *field = ridges->diagram.field;
    uint32_t face = ridges->diagram.bisector_part[end->part].face;
    struct gd__local at = place_in(field->mesh, face, &end->point);
    double reach = GD_TOL_NODE * size_at(ridges, end->part);
    for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        if (seed->is_segment) continue;
        struct gd__local place = place_in(field->mesh, face, &seed->point);
        if (gd__local_length(gd__local_minus(place, at)) <= reach) return seed;
    }
    return NULL;
}

/* Returns true if a node lies on the bisector of a part. */
static bool is_on_part(const struct gd__diagram *diagram, const struct gd__bisector_part *part,
                       const struct neighbour *near)
{
    if (near->face != part->face || (part->is_straight && !part->focus[0].linear)) return false;
    struct gd__local at = place_in(diagram->mesh, part->face, &diagram->node[near->node].point);
    double distance = gd__focus_distance(&part->focus[0], at),
           apart = distance - gd__focus_distance(&part->focus[1], at);
    return fabs(apart) <= GD_TOL_TIE * diagram->members.farthest;
}

/* Joins a loose end to the nearest node within GD_TOL_NODE. If a ridge meets the border of a view
 * or an edge at a small angle, the end moves by much more than the rounding error. The part is
 * extended or shortened to the node if the node is on its bisector. Otherwise a straight part joins
 * both. */
static enum gd_status close_gap(struct gd__ridges *ridges, uint32_t loose)
{
    const struct gd__ridge_end *end = &ridges->end[loose];
    struct gd__diagram *diagram = &ridges->diagram;
    const struct gd_mesh *mesh = diagram->mesh;
    struct gd__bisector_part part = diagram->bisector_part[end->part];
    /* along edges the reach is small: a copy of a ridge (drop_copies) may end close to another
     * node */
    double reach = (end->part < ridges->first_along ? GD_TOL_NODE : 10 * GD_TOL_CHECK) *
                   size_at(ridges, end->part);
    struct neighbour best = {.node = GD_NONE, .apart = reach};
    const struct gd__seed *seed = seed_at(ridges, end);
    if (seed) {
        diagram->node[*node_of(ridges, end)].point = seed->point;
        return GD_OK;
    }
    if (end->kind == GD_POINT_FACE) look_in_face(ridges, loose, end->element, &best);
    for (uint32_t k = 0; k < 2 && end->kind == GD_POINT_EDGE; k++)
        look_in_face(ridges, loose, mesh->side_face[2 * end->element + k], &best);
    if (best.node == GD_NONE) return GD_OK;
    double rounding = GD_TOL_CHECK * size_at(ridges, end->part);
    if (best.apart <= rounding || is_on_part(diagram, &part, &best)) {
        diagram->node[*node_of(ridges, end)].bisector_part[0] = GD_NONE;
        *node_of(ridges, end) = best.node;
        count_end(diagram, end->part, end->end);
        return GD_OK;
    }
    part.face = best.face;
    part.node[0] = *node_of(ridges, end);
    part.node[1] = best.node;
    part.is_straight = true;
    part.focus[0].linear = false;
    uint32_t number;
    enum gd_status status = add_part(ridges, &part, ridges->angle[end->part], &number);
    if (!status) count_part(diagram, number);
    return status;
}

/* Removes parts along an edge that end loosely on the edge. Such a part is a copy of a ridge that
 * leaves the edge at a tiny angle. */
static void drop_copies(struct gd__ridges *ridges)
{
    struct gd__diagram *diagram = &ridges->diagram;
    for (uint32_t i = 0; i < ridges->end_count; i++) {
        const struct gd__ridge_end *end = &ridges->end[i];
        struct gd__bisector_part *part = &diagram->bisector_part[end->part];
        if (end->part < ridges->first_along || end->kind != GD_POINT_EDGE ||
            !is_loose(ridges, end) || seed_at(ridges, end))
            continue;
        const uint32_t *face = &diagram->mesh->side_face[2 * end->element];
        if (face[0] != GD_NONE && face[1] != GD_NONE) part->node[1] = part->node[0];
    }
    count_parts(diagram);
}

static enum gd_status close_gaps(struct gd__ridges *ridges)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < ridges->end_count && !status; i++)
        if (is_loose(ridges, &ridges->end[i])) status = close_gap(ridges, i);
    return status;
}

/* --- removal of parts ------------------------------------------------------------------------- */

/* Removes the parts for which `keep` is false, and renumbers the others. */
static void keep_parts(struct gd__ridges *ridges, const bool *keep)
{
    struct gd__diagram *diagram = &ridges->diagram;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < diagram->bisector_part_count; i++) {
        if (!keep[i]) continue;
        ridges->angle[kept] = ridges->angle[i];
        diagram->bisector_part[kept++] = diagram->bisector_part[i];
    }
    ridges->angle_count = diagram->bisector_part_count = kept;
    count_parts(diagram);
}

/* --- branches --------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Marks the parts of the branches whose greatest angle is at least `min_angle`. `parent` and `keep`
 * have an entry for each part. */
static void mark_branches(struct gd__ridges *ridges, double min_angle, uint32_t *parent, bool *keep)
{
    const struct gd__diagram *diagram = &ridges->diagram;
    uint32_t parts = diagram->bisector_part_count;
    for (uint32_t i = 0; i < parts; i++) parent[i] = i;
    for (uint32_t i = 0; i < diagram->node_count; i++) {
        const struct gd__node *node = &diagram->node[i];
        if (node->is_end || node->bisector_part[1] == GD_NONE) continue;
        parent[root_of(parent, node->bisector_part[0])] = root_of(parent, node->bisector_part[1]);
    }
    for (uint32_t i = 0; i < parts; i++) keep[i] = false;
    for (uint32_t i = 0; i < parts; i++)
        if (ridges->angle[i] >= min_angle) keep[root_of(parent, i)] = true;
    for (uint32_t i = 0; i < parts; i++)
        keep[i] = keep[root_of(parent, i)] && !is_point(&diagram->bisector_part[i]);
}

/* Makes a node an end of lines if its two parts have different members. */
static void end_at_members(struct gd__diagram *diagram)
{
    for (uint32_t i = 0; i < diagram->node_count; i++) {
        struct gd__node *node = &diagram->node[i];
        if (node->bisector_part[1] == GD_NONE) continue;
        const uint32_t *a = diagram->bisector_part[node->bisector_part[0]].member,
                       *b = diagram->bisector_part[node->bisector_part[1]].member;
        node->is_end |= a[0] != b[0] || a[1] != b[1];
    }
}

enum gd_status gd__ridges_join(struct gd__ridges *ridges, double min_angle)
{
    struct gd__diagram *diagram = &ridges->diagram;
    enum gd_status status = add_intervals(ridges);
    if (status) return status;
    if (ridges->end_count) qsort(ridges->end, ridges->end_count, sizeof *ridges->end, by_place);
    status = give_nodes(ridges);
    if (status) return status;
    count_parts(diagram);
    status = close_gaps(ridges);
    if (status) return status;
    drop_copies(ridges);
    size_t parts = diagram->bisector_part_count + (size_t)1;
    bool *keep = malloc(parts * sizeof *keep);
    uint32_t *parent = malloc(parts * sizeof *parent);
    if (keep && parent) {
        mark_branches(ridges, min_angle, parent, keep);
        keep_parts(ridges, keep);
        end_at_members(diagram);
    } else {
        status = GD_NO_MEMORY;
    }
    free(keep);
    free(parent);
    return status;
}
