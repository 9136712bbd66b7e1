#include <stdlib.h>

#include "field/ridges.h"

/* Gaps in the graph of ridges. If a ridge meets the border of a view or an edge at a small angle,
 * its end moves by much more than the rounding error. Such a loose end is joined to the nearest
 * node within GD_TOL_NODE, or to a loose end within the rounding error of its ridge. */

#define GAP_SLACKS 16 /* an end is off by at most this many rounding errors, divided by the angle */

/* The position of a node, for lists that are sorted by element. */
struct place {
    struct gd_point point;
    double x;      /* position on the edge or in the face */
    uint32_t node; /* the node, or the node to which it was joined */
};

struct places {
    struct place *place;
    uint32_t count;
};

/* A node near a loose end, in a face that contains both. */
struct neighbour {
    uint32_t node, face;
    double apart;
};

static int by_element(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    if (x->point.kind != y->point.kind) return x->point.kind < y->point.kind ? -1 : 1;
    if (x->point.element != y->point.element) return x->point.element < y->point.element ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

/* --- marks of elements ------------------------------------------------------------------------ */

/* Marks of vertices, edges and faces, in this order. */
static size_t mark_of(const struct gd_mesh *mesh, enum gd_point_kind kind, uint32_t element)
{
    size_t edges = mesh->vertex_count, faces = edges + mesh->edge_count;
    return element + (kind == GD_POINT_FACE ? faces : kind == GD_POINT_EDGE ? edges : 0);
}

/* Marks a face, its edges and its vertices. Does nothing if `face` is GD_NONE. */
static void mark_face(const struct gd_mesh *mesh, bool *marks, uint32_t face)
{
    if (face == GD_NONE) return;
    marks[mark_of(mesh, GD_POINT_FACE, face)] = true;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k];
        marks[mark_of(mesh, GD_POINT_VERTEX, mesh->origin[side])] = true;
        marks[mark_of(mesh, GD_POINT_EDGE, side >> 1)] = true;
    }
}

/* --- lists of nodes --------------------------------------------------------------------------- */

static struct place place_of(const struct gd__diagram *diagram, uint32_t node)
{
    const struct gd_point *point = &diagram->node[node].point;
    double x = point->kind == GD_POINT_EDGE ? point->weight[0]
               : point->kind == GD_POINT_FACE
                   ? gd__point_local(diagram->mesh, point->element, point).x
                   : 0;
    return (struct place){*point, x, node};
}

/* Lists the nodes on marked elements, or the loose nodes if `marks` is NULL, sorted by element.
 * *out must be empty. */
static enum gd_status list_places(struct gd__ridges *ridges, const bool *marks, struct places *out)
{
    struct gd__diagram *diagram = &ridges->diagram;
    uint32_t capacity = 0;
    enum gd_status status = GD_OK;
    GD__PACED (&ridges->pace, i, diagram->node_count) {
        const struct gd__node *node = &diagram->node[i];
        bool is_listed = marks
                             ? marks[mark_of(diagram->mesh, node->point.kind, node->point.element)]
                             : gd__ridge_is_loose(node);
        if (status || !is_listed) continue;
        struct place place = place_of(diagram, i);
        status = gd__arena_append(&diagram->arena, &out->place, &out->count, &capacity, &place,
                                  sizeof place);
    }
    if (!status) status = ridges->pace.status;
    if (!status && out->count) qsort(out->place, out->count, sizeof *out->place, by_element);
    return status;
}

/* Marks the faces of loose ends, with their edges and vertices. */
static void mark_gaps(const struct gd__ridges *ridges, const struct places *loose, bool *marks)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    for (uint32_t i = 0; i < loose->count; i++) {
        const struct gd_point *point = &loose->place[i].point;
        if (point->kind == GD_POINT_FACE) mark_face(mesh, marks, point->element);
        for (uint32_t k = 0; k < 2 && point->kind == GD_POINT_EDGE; k++)
            mark_face(mesh, marks, mesh->side_face[2 * point->element + k]);
    }
}

/* --- the neighbour of a loose end ------------------------------------------------------------- */

/* Returns the first entry on this element or on a later one. */
static uint32_t first_on(const struct places *places, enum gd_point_kind kind, uint32_t element)
{
    uint32_t from = 0, to = places->count;
    while (from < to) {
        uint32_t middle = from + (to - from) / 2;
        const struct gd_point *point = &places->place[middle].point;
        bool is_before = point->kind != kind ? point->kind < kind : point->element < element;
        if (is_before)
            from = middle + 1;
        else
            to = middle;
    }
    return from;
}

/* A loose end: the end of the only part at a node. */
struct loose {
    struct gd__ridges *ridges;
    const struct places *places; /* the nodes near loose ends */
    uint32_t node, part, end;
    struct gd_point point;
    double sure; /* a node at most this far away is at the same position */
};

/* Searches the nodes on one element of a face. If one is nearer than `best`, replaces `best` by
 * it. */
static void look_on(const struct loose *loose, uint32_t face, enum gd_point_kind kind,
                    uint32_t element, struct neighbour *best)
{
    const struct gd__diagram *diagram = &loose->ridges->diagram;
    const struct places *places = loose->places;
    uint32_t other_end = diagram->bisector_part[loose->part].node[!loose->end];
    struct gd__local at = gd__point_local(diagram->mesh, face, &loose->point);
    for (uint32_t i = first_on(places, kind, element); i < places->count; i++) {
        const struct place *place = &places->place[i];
        if (place->point.kind != kind || place->point.element != element) break;
        const struct gd__node *node = &diagram->node[place->node];
        if (place->node == loose->node || (place->node == other_end && gd__ridge_is_loose(node)))
            continue;
        double away = gd__local_length(
            gd__local_minus(gd__point_local(diagram->mesh, face, &place->point), at));
        bool is_match = away <= loose->sure || gd__ridge_is_loose(node);
        if (is_match && away < best->apart) *best = (struct neighbour){place->node, face, away};
    }
}

static void look_in_face(const struct loose *loose, uint32_t face, struct neighbour *best)
{
    const struct gd_mesh *mesh = loose->ridges->diagram.mesh;
    if (face == GD_NONE) return;
    look_on(loose, face, GD_POINT_FACE, face, best);
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k];
        look_on(loose, face, GD_POINT_EDGE, side >> 1, best);
        look_on(loose, face, GD_POINT_VERTEX, mesh->origin[side], best);
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

/* Returns the distance up to which nodes count as the same node. For a part along an edge this
 * distance is small, because a copy of a ridge (drop_copies) may end close to another node. */
static double sure_reach(const struct gd__ridges *ridges, uint32_t part)
{
    return (part < ridges->first_along ? GD_TOL_NODE : 10 * GD_TOL_CHECK) * size_at(ridges, part);
}

/* Returns a bound of the rounding error of a part's ends. The bound grows as the angle decreases.
 * Two loose ends that are at most this far apart are ends of one ridge. */
static double rounding_at(const struct gd__ridges *ridges, uint32_t part)
{
    double size = size_at(ridges, part);
    if (ridges->pair[part].source[0] == GD_NONE) return 0;
    double most =
               gd__face_farthest(ridges->diagram.field, ridges->diagram.bisector_part[part].face),
           rounding = GAP_SLACKS * gd__envelope_slack(most, size) / ridges->pair[part].angle;
    return fmin(rounding, GD_TOL_RIDGE_GAP * size);
}

/* --- joining ---------------------------------------------------------------------------------- */

/* Returns the point seed at the end of a part, or NULL. A ridge may begin at such a seed if the
 * seed is a joint of a curve. */
static const struct gd__seed *seed_at(const struct gd__ridges *ridges, uint32_t part,
                                      const struct gd_point *point)
{
    const struct gd_field *field = ridges->diagram.field;
    uint32_t face = ridges->diagram.bisector_part[part].face;
    struct gd__local at = gd__point_local(field->mesh, face, point);
    double reach = GD_TOL_NODE * size_at(ridges, part);
    for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        if (seed->is_segment) continue;
        struct gd__local place = gd__point_local(field->mesh, face, &seed->point);
        if (gd__local_length(gd__local_minus(place, at)) <= reach) return seed;
    }
    return NULL;
}

/* Sets *out to true if a node lies on the bisector of a part. */
static enum gd_status is_on_part(struct gd__ridges *ridges, uint32_t part,
                                 const struct neighbour *near, bool *out)
{
    const struct gd__diagram *diagram = &ridges->diagram;
    uint32_t face = diagram->bisector_part[part].face;
    struct gd__focus focus[2];
    *out = false;
    if (near->face != face || ridges->pair[part].source[0] == GD_NONE) return GD_OK;
    enum gd_status status = gd__ridge_foci(ridges, part, focus);
    if (status) return status;
    struct gd__local at = gd__point_local(diagram->mesh, face, &diagram->node[near->node].point);
    double apart = gd__focus_distance(&focus[0], at) - gd__focus_distance(&focus[1], at);
    *out = fabs(apart) <= GD_TOL_TIE * diagram->members.farthest;
    return GD_OK;
}

/* Records that the node of a loose end was joined to `node`. Ends that are later found near this
 * loose end are then joined to `node` too. */
static void redirect(const struct loose *loose, uint32_t node)
{
    const struct places *places = loose->places;
    const struct gd_point *point = &loose->point;
    for (uint32_t i = first_on(places, point->kind, point->element); i < places->count; i++) {
        struct place *place = &places->place[i];
        if (place->point.kind != point->kind || place->point.element != point->element) break;
        if (place->node == loose->node) place->node = node;
    }
}

/* Joins a loose end to a node. If the node is on the bisector of the end's part, the part is
 * extended or shortened to the node. Otherwise a straight part connects the end with the node. */
static enum gd_status join(const struct loose *loose, const struct neighbour *near)
{
    struct gd__ridges *ridges = loose->ridges;
    struct gd__diagram *diagram = &ridges->diagram;
    struct gd__bisector_part *part = &diagram->bisector_part[loose->part];
    bool is_same = near->apart <= GD_TOL_CHECK * size_at(ridges, loose->part);
    enum gd_status status = is_same ? GD_OK : is_on_part(ridges, loose->part, near, &is_same);
    if (status) return status;
    if (is_same) {
        diagram->node[loose->node].bisector_part[0] = GD_NONE;
        part->node[loose->end] = near->node;
        gd__diagram_count_end(diagram, loose->part, loose->end);
        redirect(loose, near->node);
        return GD_OK;
    }
    const struct gd__ridge bridge = {.part = {.face = near->face,
                                              .member = {part->member[0], part->member[1]},
                                              .node = {loose->node, near->node},
                                              .arc = GD_NONE},
                                     .pair = {ridges->pair[loose->part].angle, {GD_NONE, GD_NONE}}};
    return gd__ridges_bridge(ridges, &bridge);
}

static enum gd_status close_gap(struct gd__ridges *ridges, const struct places *places,
                                const struct place *place)
{
    struct gd__diagram *diagram = &ridges->diagram;
    const struct gd_mesh *mesh = diagram->mesh;
    uint32_t node = place->node, part = diagram->node[node].bisector_part[0];
    const struct loose loose = {ridges,
                                places,
                                node,
                                part,
                                diagram->bisector_part[part].node[1] == node,
                                place->point,
                                sure_reach(ridges, part)};
    double most = fmax(loose.sure, rounding_at(ridges, part));
    struct neighbour best = {.node = GD_NONE, .apart = most};
    const struct gd__seed *seed = seed_at(ridges, part, &loose.point);
    if (seed) {
        diagram->node[node].point = seed->point;
        return GD_OK;
    }
    if (loose.point.kind == GD_POINT_FACE) look_in_face(&loose, loose.point.element, &best);
    for (uint32_t k = 0; k < 2 && loose.point.kind == GD_POINT_EDGE; k++)
        look_in_face(&loose, mesh->side_face[2 * loose.point.element + k], &best);
    return best.node == GD_NONE ? GD_OK : join(&loose, &best);
}

/* Removes parts along an edge that end loosely on the edge. Such a part is a copy of a ridge that
 * leaves the edge at a tiny angle. `behind` is the number of the first part after the parts along
 * edges. */
static void drop_copies(struct gd__ridges *ridges, uint32_t behind)
{
    struct gd__diagram *diagram = &ridges->diagram;
    for (uint32_t i = ridges->first_along; i < behind; i++) {
        struct gd__bisector_part *part = &diagram->bisector_part[i];
        for (uint32_t k = 0; k < 2 && !gd__ridge_is_point(part); k++) {
            const struct gd__node *node = &diagram->node[part->node[k]];
            if (node->point.kind != GD_POINT_EDGE || !gd__ridge_is_loose(node) ||
                seed_at(ridges, i, &node->point))
                continue;
            const uint32_t *face = &diagram->mesh->side_face[2 * node->point.element];
            if (face[0] != GD_NONE && face[1] != GD_NONE) part->node[1] = part->node[0];
        }
    }
    gd__ridges_count(ridges);
}

static enum gd_status find_places(struct gd__ridges *ridges, struct places *loose,
                                  struct places *near)
{
    struct gd__arena *arena = &ridges->diagram.arena;
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    bool *marks = gd__arena_zeroed(
        arena, (size_t)mesh->vertex_count + mesh->edge_count + mesh->face_count, sizeof *marks);
    if (!marks) return arena->status;
    enum gd_status status = list_places(ridges, NULL, loose);
    if (!status) mark_gaps(ridges, loose, marks);
    return status ? status : list_places(ridges, marks, near);
}

enum gd_status gd__ridges_close_gaps(struct gd__ridges *ridges)
{
    struct places loose = {NULL, 0}, near = {NULL, 0};
    uint32_t behind = ridges->diagram.bisector_part_count;
    enum gd_status status = find_places(ridges, &loose, &near);
    for (uint32_t i = 0; i < loose.count && !status; i++) {
        if (gd__ridge_is_loose(&ridges->diagram.node[loose.place[i].node]))
            status = close_gap(ridges, &near, &loose.place[i]);
        if (!status) status = gd__pace_step(&ridges->pace, 16);
    }
    if (status) return status;
    drop_copies(ridges, behind);
    return ridges->pace.status;
}
