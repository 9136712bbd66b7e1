#include "cut/nodes.h"

#include <string.h>

#include "mesh/canonical.h"

uint32_t *gd__cut_numbers(struct gd__arena *arena, size_t count)
{
    uint32_t *numbers = gd__arena_take(arena, count, sizeof *numbers);
    if (numbers) memset(numbers, 0xff, count * sizeof *numbers);
    return numbers;
}

/* --- sizes ------------------------------------------------------------------------------------ */

double gd__nodes_reach(const struct gd__nodes *nodes, uint32_t face)
{
    const struct gd_side *side = &nodes->mesh->side[nodes->mesh->face_side[face][0]];
    return nodes->snap * fmax(side->length, fmax(side->left_length, side->right_length));
}

/* Returns the reach of an edge: the greater one of the reaches of its faces. */
static double reach_of_edge(const struct gd__nodes *nodes, uint32_t edge)
{
    double reach = 0;
    for (uint32_t h = 2 * edge; h < 2 * edge + 2; h++) {
        uint32_t face = nodes->mesh->side_face[h];
        if (face != GD_NONE) reach = fmax(reach, gd__nodes_reach(nodes, face));
    }
    return reach;
}

static void note_shift(struct gd__nodes *nodes, double length)
{
    nodes->shift = fmax(nodes->shift, length);
}

/* --- new nodes -------------------------------------------------------------------------------- */

/* Inserts a new node at the front of the list of its edge or face. */
static enum gd_status nodes_add(struct gd__nodes *nodes, struct gd_point point,
                                struct gd__site site, uint32_t *first, uint32_t *out)
{
    const struct gd__node node = {point, site, *first};
    enum gd_status status = gd__arena_append(nodes->arena, &nodes->items, &nodes->count,
                                             &nodes->capacity, &node, sizeof node);
    if (!status) *out = *first = nodes->mesh->vertex_count + nodes->count - 1;
    return status;
}

/* Returns the node of an edge that is nearest to the parameter `part`, if it is within the distance
 * `reach`. Otherwise returns GD_NONE. */
static uint32_t find_on_edge(struct gd__nodes *nodes, uint32_t edge, int64_t part, double reach)
{
    uint32_t found = GD_NONE;
    double length = nodes->mesh->side[2 * edge].length;
    for (uint32_t n = nodes->of_edge[edge]; n != GD_NONE; n = gd__node(nodes, n)->next) {
        double distance = fabs(gd__from_lattice(gd__node(nodes, n)->site.u - part)) * length;
        if (distance >= reach) continue;
        reach = distance;
        found = n;
    }
    if (found != GD_NONE) note_shift(nodes, reach);
    return found;
}

static enum gd_status node_on_edge(struct gd__nodes *nodes, uint32_t edge, double t, uint32_t *out)
{
    const struct gd_mesh *mesh = nodes->mesh;
    double reach = reach_of_edge(nodes, edge), near = fmin(t, 1 - t) * mesh->side[2 * edge].length;
    if (near < reach) {
        note_shift(nodes, near);
        *out = mesh->origin[2 * edge + (t > 0.5)];
        return GD_OK;
    }
    struct gd__site site = {gd__to_lattice(t), 0};
    uint32_t found = find_on_edge(nodes, edge, site.u, reach);
    if (found != GD_NONE) {
        *out = found;
        return GD_OK;
    }
    struct gd_point point = gd__point_within_side(2 * edge, gd__from_lattice(site.u));
    return nodes_add(nodes, point, site, &nodes->of_edge[edge], out);
}

static uint32_t nearest_side(const struct gd_mesh *mesh, uint32_t face, const double weight[3],
                             double *distance)
{
    const uint32_t *side = mesh->face_side[face];
    const struct gd_side *s = &mesh->side[side[0]];
    double double_area = s->length * s->left_length * s->left_y;
    uint32_t best = 0;
    for (uint32_t k = 0; k < 3; k++) {
        double d = weight[(k + 2) % 3] * double_area / mesh->side[side[k]].length;
        if (k && d >= *distance) continue;
        *distance = d;
        best = k;
    }
    return best;
}

/* Returns the node at the projection of a position onto a side of the face. */
static enum gd_status node_on_side(struct gd__nodes *nodes, uint32_t face, uint32_t k,
                                   struct gd__local place, uint32_t *out)
{
    static const struct gd__site corner[3] = {{0, 0}, {GD__LATTICE, 0}, {0, GD__LATTICE}};
    struct gd__local a = gd__site_local(nodes->mesh, face, corner[k]),
                     b = gd__site_local(nodes->mesh, face, corner[(k + 1) % 3]);
    double dx = b.x - a.x, dy = b.y - a.y;
    double t = ((place.x - a.x) * dx + (place.y - a.y) * dy) / (dx * dx + dy * dy);
    uint32_t h = nodes->mesh->face_side[face][k];
    t = fmin(fmax(t, 0), 1);
    return node_on_edge(nodes, h / 2, h % 2 ? 1 - t : t, out);
}

static uint32_t find_in_face(struct gd__nodes *nodes, uint32_t face, struct gd__local place,
                             double reach)
{
    uint32_t found = GD_NONE;
    for (uint32_t n = nodes->of_face[face]; n != GD_NONE; n = gd__node(nodes, n)->next) {
        struct gd__local other = gd__site_local(nodes->mesh, face, gd__node(nodes, n)->site);
        double distance = hypot(other.x - place.x, other.y - place.y);
        if (distance >= reach) continue;
        reach = distance;
        found = n;
    }
    if (found != GD_NONE) note_shift(nodes, reach);
    return found;
}

enum gd_status gd__node_in_face(struct gd__nodes *nodes, uint32_t face, double u, double v,
                                uint32_t *out)
{
    const double weight[3] = {1 - u - v, u, v};
    struct gd__site site = {gd__to_lattice(u), gd__to_lattice(v)};
    struct gd__local place = gd__site_local(nodes->mesh, face, site);
    double reach = gd__nodes_reach(nodes, face), distance = 0;
    uint32_t side = nearest_side(nodes->mesh, face, weight, &distance);
    if (distance < reach) {
        note_shift(nodes, fmax(distance, 0));
        return node_on_side(nodes, face, side, place, out);
    }
    uint32_t found = find_in_face(nodes, face, place, reach);
    if (found != GD_NONE) {
        *out = found;
        return GD_OK;
    }
    double w1 = gd__from_lattice(site.u), w2 = gd__from_lattice(site.v);
    struct gd_point point = {
        .kind = GD_POINT_FACE, .element = face, .weight = {1 - w1 - w2, w1, w2}};
    return nodes_add(nodes, point, site, &nodes->of_face[face], out);
}

enum gd_status gd__node_of_point(struct gd__nodes *nodes, const struct gd_point *point,
                                 uint32_t *out)
{
    switch (point->kind) {
    case GD_POINT_EDGE:
        return node_on_edge(nodes, point->element, point->weight[0], out);
    case GD_POINT_FACE:
        return gd__node_in_face(nodes, point->element, point->weight[1], point->weight[2], out);
    case GD_POINT_VERTEX:
        break;
    }
    *out = point->element;
    return GD_OK;
}

/* --- positions -------------------------------------------------------------------------------- */

struct gd_point gd__node_point(const struct gd__nodes *nodes, uint32_t node)
{
    const struct gd__node *new = gd__node(nodes, node);
    return new ? new->point : (struct gd_point){.kind = GD_POINT_VERTEX, .element = node};
}

uint32_t gd__node_sides(const struct gd__nodes *nodes, uint32_t face, uint32_t node)
{
    const struct gd_mesh *mesh = nodes->mesh;
    const struct gd_point point = gd__node_point(nodes, node);
    uint32_t sides = 0;
    for (uint32_t k = 0; k < 3 && point.kind != GD_POINT_FACE; k++) {
        uint32_t h = mesh->face_side[face][k];
        bool is_on = point.kind == GD_POINT_EDGE
                         ? h / 2 == point.element
                         : mesh->origin[h] == node || mesh->origin[h ^ 1] == node;
        if (is_on) sides |= 1u << k;
    }
    return sides;
}

struct gd__site gd__site_of_point(const struct gd_mesh *mesh, uint32_t face,
                                  const struct gd_point *point)
{
    if (point->kind == GD_POINT_FACE)
        return (struct gd__site){gd__to_lattice(point->weight[1]),
                                 gd__to_lattice(point->weight[2])};
    int64_t weight[3] = {0};
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t h = mesh->face_side[face][k];
        if (point->kind == GD_POINT_VERTEX && mesh->origin[h] == point->element)
            weight[k] = GD__LATTICE;
        if (point->kind != GD_POINT_EDGE || h / 2 != point->element) continue;
        int64_t part = gd__to_lattice(point->weight[0]);
        weight[(k + 1) % 3] = h % 2 ? GD__LATTICE - part : part;
        weight[k] = GD__LATTICE - weight[(k + 1) % 3];
    }
    return (struct gd__site){weight[1], weight[2]};
}

struct gd__site gd__node_site(const struct gd__nodes *nodes, uint32_t face, uint32_t node)
{
    const struct gd_point point = gd__node_point(nodes, node);
    return gd__site_of_point(nodes->mesh, face, &point);
}

struct gd__local gd__site_local(const struct gd_mesh *mesh, uint32_t face, struct gd__site site)
{
    return gd__side_local(&mesh->side[mesh->face_side[face][0]], gd__from_lattice(site.u),
                          gd__from_lattice(site.v));
}

uint32_t gd__nodes_walk(const struct gd__nodes *nodes, uint32_t face, struct gd__node_walk *walk)
{
    const uint32_t *side = nodes->mesh->face_side[face];
    if (walk->stage < 3) return nodes->mesh->origin[side[walk->stage++]];
    /* `next` is 0 at first; 0 is not the number of a new node */
    while (walk->next == 0 || walk->next == GD_NONE) {
        if (walk->stage == 7) return GD_NONE;
        uint32_t list = walk->stage++ - 3;
        walk->next = list < 3 ? nodes->of_edge[side[list] / 2] : nodes->of_face[face];
    }
    uint32_t node = walk->next;
    walk->next = gd__node(nodes, node)->next;
    return node;
}
