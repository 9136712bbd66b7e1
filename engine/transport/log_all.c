#include "gd/vector.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "field/layout.h"
#include "mesh/canonical.h"
#include "transport/surface_ray.h"
#include "line/unfold.h"

/* The log map at one point, computed for all vertices in order of distance. If the last bend of the
 * path to a vertex is at another vertex, the paths to both vertices leave the point in the same
 * direction. If the path to a vertex is straight, it is followed back from the vertex until it
 * crosses an edge with a suitable end. An end is suitable if its path is also straight and runs
 * through the same strip of faces. The directions of the two paths at the point then differ by the
 * angle between the vertex and this end in the unfolded strip. */

struct map {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    struct gd_point from;
    double *ahead; /* for each vertex, turn (line/turn.h) at `from`; NAN if unknown */
};

/* The state of a walk from a vertex back to the source. `rest` is the remaining distance to the
 * source. */
struct wedge_view {
    struct gd__surface_ray walk;
    double rest;
};

static bool is_root(const struct map *map, uint32_t source)
{
    if (source >= map->mesh->vertex_count) return source != GD_NONE;
    return map->from.kind == GD_POINT_VERTEX && map->from.element == source;
}

/* --- one vertex ------------------------------------------------------------------------------- */

/* Traces the complete path to a vertex, and stores the turn in which it leaves the source. */
static enum gd_status trace_it(struct map *map, uint32_t vertex)
{
    struct gd_point point = gd__point_of_vertex(vertex);
    struct gd_path path;
    struct gd__straight part;
    enum gd_status status = gd_field_path(map->field, &point, &path);
    if (status) return status;
    uint32_t first = path.count - 1;
    do first--;
    while (first > 0 && path.points[first].kind == GD_POINT_EDGE);
    status = gd__unfold(map->mesh, &path.points[first], path.count - first, &part);
    if (!status) map->ahead[vertex] = part.back;
    gd_path_free(&path);
    return status;
}

/* Computes the turn of a vertex that shares a face or an edge with the source. */
static enum gd_status look_beside(struct map *map, uint32_t vertex)
{
    struct gd_point points[2] = {map->from, gd__point_of_vertex(vertex)};
    struct gd__straight part;
    enum gd_status status = gd__unfold(map->mesh, points, 2, &part);
    if (!status) map->ahead[vertex] = part.ahead;
    return status;
}

/* Returns the position of the source in the frame of the walk's side. */
static struct gd__local source_of(const struct wedge_view *sight)
{
    return (struct gd__local){sight->walk.t + sight->rest * sight->walk.dx,
                              sight->rest * sight->walk.dy};
}

static bool has_arrived(const struct map *map, const struct wedge_view *sight)
{
    const struct gd_mesh *mesh = map->mesh;
    uint32_t side = sight->walk.side, face = mesh->side_face[side];
    const struct gd_side *s = &mesh->side[side];
    struct gd__local source = source_of(sight);
    double tolerance = GD_TOL_ARRIVED * (s->length + s->left_length), w[3];
    if (source.y > s->left_length * s->left_y + tolerance) return false;
    if (map->from.kind == GD_POINT_FACE && map->from.element != face) return false;
    gd__point_weights(mesh, &map->from, face, w);
    int k = gd__place_of_side(mesh->face_side[face], side);
    struct gd__local at =
        gd__face_local(mesh, side, (double[3]){w[k], w[(k + 1) % 3], w[(k + 2) % 3]});
    return w[0] + w[1] + w[2] > 0 && hypot(at.x - source.x, at.y - source.y) <= tolerance;
}

/* Returns the turn towards the source at a vertex whose path is straight. Computes it from the
 * vertex' predecessor. */
static double back_of(const struct map *map, uint32_t vertex)
{
    const struct gd_mesh *mesh = map->mesh;
    struct gd__predecessor predecessor = map->field->predecessor[vertex];
    const struct gd_side *s = &mesh->side[predecessor.side];
    struct gd_point point = gd__point_of_vertex(vertex);
    return gd__turn_in_face(mesh, &point, predecessor.side,
                            predecessor.x - s->left_length * s->left_x,
                            -predecessor.y - s->left_length * s->left_y);
}

/* Computes the direction to the vertex from the direction to an end of the crossed edge. Returns
 * false if the path to this end does not run through the same strip. */
static bool lean_on(struct map *map, const struct wedge_view *sight, uint32_t end, double x,
                    double *ahead)
{
    const struct gd_mesh *mesh = map->mesh;
    struct gd__predecessor predecessor = map->field->predecessor[end];
    if (isnan(map->ahead[end]) || predecessor.side == GD_NONE || !is_root(map, predecessor.source))
        return false;
    struct gd__local source = source_of(sight), to = {x - source.x, -source.y};
    double distance = map->field->distance[end];
    if (!(fabs(hypot(to.x, to.y) - distance) <= GD_TOL_SAME_SOURCE * distance)) return false;
    struct gd_point point = gd__point_of_vertex(end);
    double apart =
        gd__turn_in_face(mesh, &point, sight->walk.side, -to.x, -to.y) - back_of(map, end);
    if (!(fabs(remainder(apart, mesh->total_angle[end])) <= GD_TOL_SAME_SOURCE)) return false;
    double dx = -sight->walk.dx, dy = -sight->walk.dy;
    *ahead = gd__turn_reduce(mesh, &map->from,
                             map->ahead[end] + atan2(to.x * dy - to.y * dx, to.x * dx + to.y * dy));
    return true;
}

/* Computes the direction to the vertex by lean_on. Tries the farther end of the crossed edge first,
 * because it gives a more precise angle. */
static bool lean(struct map *map, const struct wedge_view *sight, double *ahead)
{
    uint32_t side = sight->walk.side,
             ends[2] = {map->mesh->origin[side], map->mesh->origin[side ^ 1]};
    double x[2] = {0, map->mesh->side[side].length};
    int far = map->field->distance[ends[1]] > map->field->distance[ends[0]];
    return lean_on(map, sight, ends[far], x[far], ahead) ||
           lean_on(map, sight, ends[!far], x[!far], ahead);
}

/* Starts the walk back across the side opposite to the vertex. */
static struct wedge_view sight_from(const struct map *map, uint32_t vertex)
{
    struct gd__predecessor predecessor = map->field->predecessor[vertex];
    const struct gd_side *s = &map->mesh->side[predecessor.side];
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    double dx = predecessor.x - px, dy = -predecessor.y - py, length = hypot(dx, dy),
           gone = length * py / (py + predecessor.y);
    double t = px + dx / length * gone;
    return (struct wedge_view){{predecessor.side ^ 1, s->length - t, -dx / length, -dy / length},
                               length - gone};
}

static enum gd_status look_back(struct map *map, uint32_t vertex)
{
    const struct gd_mesh *mesh = map->mesh;
    struct wedge_view sight = sight_from(map, vertex);
    while (sight.rest > 0 && !gd__side_is_boundary(mesh, sight.walk.side)) {
        const struct gd_side *s = &mesh->side[sight.walk.side];
        if (has_arrived(map, &sight)) {
            map->ahead[vertex] =
                gd__turn_in_face(mesh, &map->from, sight.walk.side, -sight.walk.dx, -sight.walk.dy);
            return GD_OK;
        }
        if (lean(map, &sight, &map->ahead[vertex])) return GD_OK;
        struct gd__face_crossing passage = gd__surface_ray_cross(s, &sight.walk);
        if (!(passage.run >= 0 && sight.walk.t >= 0 && sight.walk.t <= passage.edge)) break;
        sight.rest -= passage.run;
    }
    return trace_it(map, vertex);
}

static enum gd_status look_from(struct map *map, uint32_t vertex)
{
    struct gd__predecessor predecessor = map->field->predecessor[vertex];
    /* the path bends on an edge */
    if (predecessor.source == GD_NONE && predecessor.side != GD_NONE) return trace_it(map, vertex);
    if (is_root(map, predecessor.source)) {
        bool is_beside = predecessor.side == GD_NONE || predecessor.y < 0;
        return is_beside ? look_beside(map, vertex) : look_back(map, vertex);
    }
    if (predecessor.source == GD_NONE) return GD_INTERNAL;
    map->ahead[vertex] = map->ahead[predecessor.source];
    return GD_OK;
}

/* --- all vertices ----------------------------------------------------------------------------- */

struct entry {
    double distance;
    uint32_t vertex;
};

static int by_distance(const void *a, const void *b)
{
    double d = ((const struct entry *)a)->distance, e = ((const struct entry *)b)->distance;
    return d < e ? -1 : d > e;
}

/* Lists the reached vertices in order of distance, and returns their number. */
static uint32_t sort_vertices(const struct gd_field *field, struct entry *entries)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < field->mesh->vertex_count; v++)
        if (field->distance[v] < GD__FAR) entries[count++] = (struct entry){field->distance[v], v};
    qsort(entries, count, sizeof *entries, by_distance);
    return count;
}

static enum gd_status log_all_fill(struct map *map, struct entry *entries,
                                   const struct gd_control *control)
{
    enum { CHUNK = 1024 };
    enum gd_status status = GD_OK;
    uint32_t count = sort_vertices(map->field, entries);
    for (uint32_t v = 0; v < map->mesh->vertex_count; v++) map->ahead[v] = NAN;
    for (uint32_t i = 0; i < count && !status; i++) {
        bool is_itself =
            map->from.kind == GD_POINT_VERTEX && map->from.element == entries[i].vertex;
        if (!is_itself) status = look_from(map, entries[i].vertex);
        if (!status && i % CHUNK == 0) status = gd_control_check(control, (double)i / count);
    }
    return status;
}

static void write_out(const struct map *map, double *angles, double *lengths)
{
    const struct gd_mesh *mesh = map->mesh;
    double zero = gd__turn_of_angle(mesh, &map->from, 0), scale = gd__turn_scale(mesh, &map->from);
    for (uint32_t i = 0; i < mesh->summary.index_count; i++) {
        uint32_t v = mesh->vertex_of_index[i];
        bool is_known = v != GD_NONE && !isnan(map->ahead[v]);
        angles[i] =
            is_known ? gd__turn_reduce(mesh, &map->from, map->ahead[v] - zero) / scale : NAN;
    }
    gd_field_vertex_distances(map->field, lengths);
}

enum gd_status gd_vector_log_all(const struct gd_field *field, const struct gd_control *control,
                                 double *angles, double *lengths, struct gd_detail *detail)
{
    struct map map = {.field = field, .mesh = field->mesh};
    bool is_whole = gd_field_single_seed(field, &map.from) && isinf(gd_field_reach(field));
    if (!is_whole)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the log map takes the whole field of one point");
    size_t count = field->mesh->vertex_count;
    enum gd_status status =
        gd_control_afford(control, count * (sizeof(struct entry) + sizeof *map.ahead));
    struct entry *entries = status ? NULL : malloc(count * sizeof *entries);
    map.ahead = status ? NULL : malloc(count * sizeof *map.ahead);
    if (!status)
        status = entries && map.ahead ? log_all_fill(&map, entries, control) : GD_NO_MEMORY;
    if (!status) write_out(&map, angles, lengths);
    free(entries);
    free(map.ahead);
    return status ? gd_fail_status(detail, status) : GD_OK;
}
