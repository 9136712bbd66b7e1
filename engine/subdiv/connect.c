#include "subdiv/connect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"

static enum gd_status fail_at(struct gd_detail *detail, enum gd_element kind, uint64_t a,
                              uint64_t b, enum gd_status status)
{
    gd_detail_add(detail, kind, a, b);
    return status;
}

static enum gd_status check_points(const struct gd_polygons *polygons, struct gd_detail *detail)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            double x = polygons->positions[i][axis];
            if (!isfinite(x))
                return fail_at(detail, GD_ELEMENT_VERTEX, i, 0,
                               gd_fail(detail, GD_NON_FINITE,
                                       "vertex %u has a coordinate that is not a finite number",
                                       i));
            low = fmin(low, x);
            high = fmax(high, x);
        }
    }
    double most = fmax(fabs(low), fabs(high));
    if (most > 0 && (most > GD_EXTENT_MAX || most < 1 / GD_EXTENT_MAX))
        return gd_fail(detail, GD_EXTENT, "coordinates of magnitude %g can't be computed with",
                       most);
    return GD_OK;
}

static int compare_numbers(const void *x, const void *y)
{
    uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
    return (a > b) - (a < b);
}

/* Returns true if a vertex occurs twice. `sorted` is scratch for `count` corners. */
static bool repeats(const uint32_t *corners, uint32_t count, uint32_t *sorted)
{
    memcpy(sorted, corners, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_numbers);
    for (uint32_t i = 1; i < count; i++) {
        if (sorted[i] == sorted[i - 1]) return true;
    }
    return false;
}

static enum gd_status check_face(const struct gd_polygons *polygons, uint32_t face, uint32_t arity,
                                 uint32_t *sorted, struct gd_detail *detail)
{
    uint32_t first = gd_polygons_first(polygons, face),
             count = gd_polygons_first(polygons, face + 1) - first;
    for (uint32_t i = first; i < first + count; i++) {
        if (polygons->corners[i] >= polygons->position_count)
            return fail_at(detail, GD_ELEMENT_FACE, face, 0,
                           gd_fail(detail, GD_INDEX,
                                   "face %u names vertex %u, of which there are %u", face,
                                   polygons->corners[i], polygons->position_count));
    }
    if (count < 3 || repeats(polygons->corners + first, count, sorted))
        return fail_at(
            detail, GD_ELEMENT_FACE, face, 0,
            gd_fail(detail, GD_DEGENERATE_FACE, "face %u %s", face,
                    count < 3 ? "has fewer than three corners" : "has one vertex twice"));
    if (arity == 3 && count != 3)
        return fail_at(detail, GD_ELEMENT_FACE, face, 0,
                       gd_fail(detail, GD_NOT_TRIANGLES,
                               "face %u has %u corners: Loop subdivision takes triangles only",
                               face, count));
    return GD_OK;
}

static enum gd_status check_faces(const struct gd_polygons *polygons, uint32_t arity,
                                  struct gd__arena *scratch, struct gd_detail *detail)
{
    uint32_t largest = 3;
    for (uint32_t face = 0; face < polygons->polygon_count; face++) {
        uint32_t count = gd_polygons_first(polygons, face + 1) - gd_polygons_first(polygons, face);
        largest = count > largest ? count : largest;
    }
    uint32_t *sorted = gd__arena_take(scratch, largest, sizeof *sorted);
    enum gd_status status = scratch->status;
    for (uint32_t face = 0; !status && face < polygons->polygon_count; face++)
        status = check_face(polygons, face, arity, sorted, detail);
    return status;
}

static bool all_have(const struct gd_polygons *polygons, uint32_t arity)
{
    for (uint32_t face = 0; face < polygons->polygon_count; face++) {
        if (gd_polygons_first(polygons, face + 1) - gd_polygons_first(polygons, face) != arity)
            return false;
    }
    return true;
}

static enum gd_status copy_faces(const struct gd_polygons *polygons, uint32_t arity,
                                 struct gd__arena *arena, struct gd__net *net)
{
    uint32_t sides = gd_polygons_corner_count(polygons);
    bool mixed = !all_have(polygons, arity);
    gd__net_create(net, arena, arity, polygons->position_count, sides);
    if (mixed) {
        net->first = gd__arena_take(arena, polygons->polygon_count + (size_t)1, sizeof *net->first);
        net->face_of = gd__arena_take(arena, sides, sizeof *net->face_of);
    }
    if (arena->status) return arena->status;
    net->point_count = polygons->position_count;
    net->face_count = polygons->polygon_count;
    net->side_count = sides;
    for (uint32_t i = 0; i < net->point_count; i++) {
        const double *p = polygons->positions[i];
        net->points[i] = (struct gd_vec3){p[0], p[1], p[2]};
    }
    memcpy(net->origin, polygons->corners, sides * sizeof *net->origin);
    for (uint32_t face = 0; mixed && face <= net->face_count; face++) {
        net->first[face] = gd_polygons_first(polygons, face);
        for (uint32_t i = net->first[face];
             face < net->face_count && i < gd_polygons_first(polygons, face + 1); i++)
            net->face_of[i] = face;
    }
    return GD_OK;
}

static int compare_edges(const void *x, const void *y)
{
    const struct gd__edge_key *a = x, *b = y;
    if (a->key != b->key) return a->key < b->key ? -1 : 1;
    return (a->side > b->side) - (a->side < b->side);
}

static struct gd__edge_key *sorted_edges(const struct gd__net *net, struct gd__arena *scratch)
{
    struct gd__edge_key *edges = gd__arena_take(scratch, net->side_count, sizeof *edges);
    for (uint32_t side = 0; edges && side < net->side_count; side++) {
        uint64_t a = net->origin[side], b = gd__side_end(net, side);
        edges[side] = (struct gd__edge_key){a < b ? a << 32 | b : b << 32 | a, side};
    }
    if (edges) qsort(edges, net->side_count, sizeof *edges, compare_edges);
    return edges;
}

/* Validates the `count` sides of one edge. */
static enum gd_status subdiv_connect_join(struct gd__net *net, const struct gd__edge_key *run,
                                          uint32_t count, struct gd_detail *detail)
{
    uint32_t low = (uint32_t)(run->key >> 32), high = (uint32_t)run->key, side = run[0].side;
    if (count > 2)
        return fail_at(detail, GD_ELEMENT_EDGE, low, high,
                       gd_fail(detail, GD_NON_MANIFOLD_EDGE,
                               "the edge of vertices %u and %u belongs to %u faces", low, high,
                               count));
    net->twin[side] = count == 2 ? run[1].side : GD_NONE;
    net->sharpness[side] = count == 2 ? 0 : INFINITY;
    if (count == 1) return GD_OK;
    if (net->origin[side] == net->origin[run[1].side])
        return fail_at(detail, GD_ELEMENT_EDGE, low, high,
                       gd_fail(detail, GD_NON_ORIENTABLE,
                               "faces %u and %u run along the edge of vertices %u and %u in the "
                               "same direction: turn "
                               "one of them over",
                               gd__face_of(net, side), gd__face_of(net, run[1].side), low, high));
    net->twin[run[1].side] = side;
    net->sharpness[run[1].side] = 0;
    return GD_OK;
}

static enum gd_status join_all(struct gd__net *net, const struct gd__edge_key *edges,
                               struct gd_detail *detail)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0, end; !status && i < net->side_count; i = end) {
        for (end = i + 1; end < net->side_count && edges[end].key == edges[i].key;) end++;
        status = subdiv_connect_join(net, edges + i, end - i, detail);
    }
    return status;
}

/* Checks that each vertex has only one fan: a walk around the vertex from its first outgoing side
 * must reach all its outgoing sides. */
static enum gd_status check_fans(const struct gd__net *net, struct gd__arena *scratch,
                                 struct gd_detail *detail)
{
    uint32_t *met = gd__arena_zeroed(scratch, net->point_count, sizeof *met);
    struct gd__fan fan = {.sides = gd__arena_take(scratch, net->side_count, sizeof *fan.sides)};
    enum gd_status status = scratch->status;
    for (uint32_t side = 0; !status && side < net->side_count; side++) {
        uint32_t point = net->origin[side];
        if (met[point] == 0) {
            gd__fan_around(net, side, &fan);
            /* the sides of this fan decrement this number to 1; a side of another fan then finds
               1 */
            met[point] = fan.count + 1;
        }
        if (met[point]-- == 1)
            status = fail_at(detail, GD_ELEMENT_VERTEX, point, 0,
                             gd_fail(detail, GD_NON_MANIFOLD_VERTEX,
                                     "the faces around vertex %u form more than one fan", point));
    }
    return status;
}

enum gd_status gd__net_connect(const struct gd_polygons *polygons, uint32_t arity,
                               struct gd__connecting *connecting, struct gd__net *net,
                               struct gd_detail *detail)
{
    if (polygons->polygon_count == 0)
        return gd_fail(detail, GD_EMPTY, "the control mesh has no faces");
    struct gd__arena *scratch = &connecting->scratch;
    enum gd_status status = check_points(polygons, detail);
    if (!status) status = check_faces(polygons, arity, scratch, detail);
    if (!status) status = copy_faces(polygons, arity, connecting->arena, net);
    if (status) return status;
    connecting->edges = sorted_edges(net, scratch);
    status = scratch->status ? scratch->status : join_all(net, connecting->edges, detail);
    return status ? status : check_fans(net, scratch, detail);
}
