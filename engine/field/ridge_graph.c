#include <stdlib.h>

#include "field/ridges.h"

/* The graph of ridges: parts are added, and their ends are matched at nodes. */

/* --- memory ----------------------------------------------------------------------------------- */

enum gd_status gd__ridges_open(struct gd__ridges *ridges)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    struct gd__arena *arena = &ridges->diagram.arena;
    size_t vertices = mesh->vertex_count, edges = mesh->edge_count;
    ridges->unused = GD_NONE;
    ridges->vertex_node = gd__arena_take(arena, vertices, sizeof *ridges->vertex_node);
    ridges->first_waiting = gd__arena_take(arena, edges, sizeof *ridges->first_waiting);
    ridges->has_along = gd__arena_zeroed(arena, edges, sizeof *ridges->has_along);
    if (arena->status) return arena->status;
    gd__pace_fill(&ridges->pace, ridges->vertex_node, vertices * sizeof *ridges->vertex_node);
    gd__pace_fill(&ridges->pace, ridges->first_waiting, edges * sizeof *ridges->first_waiting);
    return ridges->pace.status;
}

void gd__ridges_close(struct gd__ridges *ridges)
{
    gd__sources_destroy(&ridges->scratch.sources);
    free(ridges->scratch.view);
    gd__arena_free(&ridges->diagram.arena);
}

/* --- parts ------------------------------------------------------------------------------------ */

static enum gd_status add_part(struct gd__ridges *ridges, const struct gd__ridge *ridge,
                               uint32_t *out)
{
    struct gd__diagram *diagram = &ridges->diagram;
    uint32_t count = diagram->bisector_part_count;
    enum gd_status status =
        gd__arena_append(&diagram->arena, &ridges->pair, &count, &ridges->pair_capacity,
                         &ridge->pair, sizeof ridge->pair);
    return status ? status : gd__diagram_add_bisector_part(diagram, &ridge->part, out);
}

static uint32_t *node_of(const struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    return &ridges->diagram.bisector_part[end->part].node[end->end];
}

static enum gd_status add_node(struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    return gd__diagram_add_node(&ridges->diagram, &end->point, node_of(ridges, end));
}

static enum gd_status put_at_vertex(struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    uint32_t *node = &ridges->vertex_node[end->element];
    enum gd_status status = *node == GD_NONE ? add_node(ridges, end) : GD_OK;
    if (status) return status;
    if (*node == GD_NONE)
        *node = *node_of(ridges, end);
    else
        *node_of(ridges, end) = *node;
    return GD_OK;
}

static enum gd_status put_on_edge(struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    uint32_t *first = &ridges->first_waiting[end->element], at = ridges->unused;
    const struct gd__waiting_end waiting = {end->at.x, end->near, end->part, end->end, *first};
    if (at == GD_NONE) {
        *first = ridges->waiting_count;
        return gd__arena_append(&ridges->diagram.arena, &ridges->waiting, &ridges->waiting_count,
                                &ridges->waiting_capacity, &waiting, sizeof waiting);
    }
    ridges->unused = ridges->waiting[at].next;
    ridges->waiting[at] = waiting;
    *first = at;
    return GD_OK;
}

static enum gd_status put_here(struct gd__ridges *ridges, const struct gd__ridge_end *end)
{
    return gd__arena_append(&ridges->diagram.arena, &ridges->here, &ridges->here_count,
                            &ridges->here_capacity, end, sizeof *end);
}

enum gd_status gd__ridges_add(struct gd__ridges *ridges, const struct gd__ridge *ridge,
                              const struct gd__arc *arc)
{
    static enum gd_status (*const put[])(struct gd__ridges *, const struct gd__ridge_end *) = {
        [GD_POINT_VERTEX] = put_at_vertex,
        [GD_POINT_EDGE] = put_on_edge,
        [GD_POINT_FACE] = put_here};
    struct gd__ridge added = *ridge;
    uint32_t number;
    added.part.arc = GD_NONE;
    enum gd_status status =
        arc ? gd__diagram_add_arc(&ridges->diagram, arc, &added.part.arc) : GD_OK;
    if (!status) status = add_part(ridges, &added, &number);
    for (uint32_t k = 0; k < 2 && !status; k++) {
        struct gd__ridge_end *end = &added.end[k];
        end->part = number;
        end->end = k;
        status = put[end->kind](ridges, end);
    }
    return status;
}

enum gd_status gd__ridges_bridge(struct gd__ridges *ridges, const struct gd__ridge *ridge)
{
    uint32_t number;
    enum gd_status status = add_part(ridges, ridge, &number);
    for (uint32_t k = 0; k < 2 && !status; k++) gd__diagram_count_end(&ridges->diagram, number, k);
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
    enum gd_status status =
        gd__arena_extend(&ridges->diagram.arena, &ridges->along, &ridges->along_capacity,
                         ridges->along_count + UINT64_C(1), sizeof *ridges->along);
    if (status) return status;
    ridges->has_along[edge] = true;
    ridges->along[ridges->along_count++] =
        (struct gd__along){.edge = edge,
                           .face = ridge->part.face,
                           .member = {ridge->part.member[0], ridge->part.member[1]},
                           .from = fmin(a, b),
                           .to = fmax(a, b),
                           .angle = ridge->pair.angle,
                           .near = ridge->end[0].near};
    return GD_OK;
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
                 .node = {GD_NONE, GD_NONE}},
        .pair = {along->angle, {GD_NONE, GD_NONE}},
        .end = {end_on_edge(mesh, along, along->from), end_on_edge(mesh, along, along->to)}};
    return along->to - along->from > along->near ? gd__ridges_add(ridges, &ridge, NULL) : GD_OK;
}

/* Adds the parts along edges as disjoint intervals. Overlapping intervals of the same members are
 * joined. */
static enum gd_status add_intervals(struct gd__ridges *ridges)
{
    struct gd__along *along = ridges->along;
    enum gd_status status = GD_OK;
    ridges->first_along = ridges->diagram.bisector_part_count;
    if (ridges->along_count) qsort(along, ridges->along_count, sizeof *along, by_interval);
    for (uint32_t i = 0, next; i < ridges->along_count && !status; i = next) {
        struct gd__along *at = &along[i];
        for (next = i + 1; next < ridges->along_count; next++) {
            struct gd__along *other = &along[next];
            if (other->edge != at->edge) break;
            bool is_same = other->member[0] == at->member[0] && other->member[1] == at->member[1];
            if (other->from > at->to - at->near) break;
            if (!is_same && other->to > at->to) {
                other->from = at->to;
                break;
            }
            at->to = fmax(at->to, other->to);
            at->angle = fmax(at->angle, other->angle);
        }
        status = add_interval(ridges, at);
        if (!status) status = gd__pace_step(&ridges->pace, 4 * (next - i));
    }
    return status;
}

/* --- nodes ------------------------------------------------------------------------------------ */

static int by_place(const void *a, const void *b)
{
    const struct gd__ridge_end *x = a, *y = b;
    if (x->at.x != y->at.x) return x->at.x < y->at.x ? -1 : 1;
    if (x->part != y->part) return x->part < y->part ? -1 : 1;
    return (x->end > y->end) - (x->end < y->end);
}

/* Gives an end the node of an earlier end at the same position, or a new node. */
static enum gd_status give_node(struct gd__ridges *ridges, uint32_t i)
{
    const struct gd__ridge_end *end = &ridges->here[i];
    for (uint32_t k = i; k-- > 0 && end->at.x - ridges->here[k].at.x <= end->near;) {
        const struct gd__ridge_end *other = &ridges->here[k];
        if (gd__local_length(gd__local_minus(end->at, other->at)) > end->near) continue;
        *node_of(ridges, end) = *node_of(ridges, other);
        return GD_OK;
    }
    return add_node(ridges, end);
}

/* Gives nodes to the ends in the current face or on the current edge. */
static enum gd_status give_nodes(struct gd__ridges *ridges)
{
    enum gd_status status = GD_OK;
    if (ridges->here_count > 1)
        qsort(ridges->here, ridges->here_count, sizeof *ridges->here, by_place);
    for (uint32_t i = 0; i < ridges->here_count && !status; i++) status = give_node(ridges, i);
    ridges->here_count = 0;
    return status;
}

static enum gd_status settle_edge(struct gd__ridges *ridges, uint32_t edge)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    double length = mesh->side[2 * edge].length;
    enum gd_status status = GD_OK;
    for (uint32_t at = ridges->first_waiting[edge], next; at != GD_NONE && !status; at = next) {
        struct gd__waiting_end *waiting = &ridges->waiting[at];
        const struct gd__ridge_end end = {
            .kind = GD_POINT_EDGE,
            .element = edge,
            .at.x = waiting->t,
            .near = waiting->near,
            .point = gd__point_of_edge(mesh, edge, fmin(fmax(waiting->t / length, 0), 1)),
            .part = waiting->part,
            .end = waiting->end};
        next = waiting->next;
        waiting->next = ridges->unused;
        ridges->unused = at;
        status = put_here(ridges, &end);
    }
    ridges->first_waiting[edge] = GD_NONE;
    return status ? status : give_nodes(ridges);
}

enum gd_status gd__ridges_settle(struct gd__ridges *ridges, uint32_t face)
{
    const struct gd_mesh *mesh = ridges->diagram.mesh;
    enum gd_status status = give_nodes(ridges);
    for (int k = 0; k < 3 && !status; k++) {
        uint32_t side = mesh->face_side[face][k], other = mesh->side_face[side ^ 1];
        if ((other == GD_NONE || other <= face) && !ridges->has_along[side >> 1])
            status = settle_edge(ridges, side >> 1);
    }
    return status;
}

enum gd_status gd__ridges_finish(struct gd__ridges *ridges)
{
    enum gd_status status = add_intervals(ridges);
    for (uint32_t i = 0; i < ridges->along_count && !status; i++)
        status = settle_edge(ridges, ridges->along[i].edge);
    return status;
}

/* --- counts ----------------------------------------------------------------------------------- */

void gd__ridges_count(struct gd__ridges *ridges)
{
    struct gd__diagram *diagram = &ridges->diagram;
    GD__PACED (&ridges->pace, i, diagram->node_count) {
        diagram->node[i].is_end = false;
        diagram->node[i].bisector_part[0] = diagram->node[i].bisector_part[1] = GD_NONE;
    }
    GD__PACED (&ridges->pace, i, diagram->bisector_part_count) {
        const struct gd__bisector_part *part = &diagram->bisector_part[i];
        for (uint32_t k = 0; k < 2; k++)
            if (!gd__ridge_is_point(part)) gd__diagram_count_end(diagram, i, k);
    }
}
