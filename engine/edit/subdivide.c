/* Computes one level of subdivision. OpenMesh's subdividers are not used because they cannot be
 * stopped and do not report the edge or face of a new vertex. */
#include <stdlib.h>

#include "base/pace.h"
#include "edit/edited.h"
#include "mesh/topology.h"

struct level {
    const struct gd_mesh *mesh;
    enum gd_subdivide_scheme scheme;
    struct gd__pace pace;
    /* for each internal vertex, its number in the result; these numbers are in the order of the
       input indices */
    uint32_t *number;
    struct gd_edited made;
};

static void put(struct level *level, uint32_t at, struct gd_vec3 inside)
{
    struct gd_vec3 p = gd_vec3_scale(inside, level->mesh->unit);
    memcpy(level->made.polygons.positions[at], &p, sizeof p);
}

/* --- the old vertices ------------------------------------------------------------------------- */

/* Returns the total weight of the neighbours of an interior vertex. */
static double ring_weight(enum gd_subdivide_scheme scheme, uint32_t valence)
{
    const double pi = acos(-1);
    switch (scheme) {
    case GD_SUBDIVIDE_LOOP: /* Warren's weights */
        return valence == 3 ? 9.0 / 16 : 3.0 / 8;
    case GD_SUBDIVIDE_SQRT3: /* Kobbelt (2000), eq. 4 */
        return (4 - 2 * cos(2 * pi / valence)) / 9;
    default:
        return 0;
    }
}

static struct gd_vec3 moved_inside(const struct level *level, uint32_t vertex)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    double weight = ring_weight(level->scheme, end - first);
    struct gd_vec3 sum = {0};
    for (uint32_t i = first; i < end; i++) sum = gd_vec3_add(sum, mesh->position[mesh->fan[i].tip]);
    return gd_vec3_add(gd_vec3_scale(mesh->position[vertex], 1 - weight),
                       gd_vec3_scale(sum, weight / (end - first)));
}

/* Moves a boundary vertex by the subdivision rule for curves. The sqrt(3) scheme does not move
 * it. */
static struct gd_vec3 moved_on_boundary(const struct level *level, uint32_t vertex)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t first = mesh->fan_first[vertex], last = gd__neighbours_end(mesh, vertex) - 1;
    struct gd_vec3 ends = gd_vec3_add(mesh->position[gd__neighbour(mesh, vertex, first)],
                                      mesh->position[gd__neighbour(mesh, vertex, last)]);
    return gd_vec3_add(gd_vec3_scale(mesh->position[vertex], 0.75), gd_vec3_scale(ends, 0.125));
}

static void keep_vertices(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->summary.index_count && gd__pace(&level->pace, 20); i++) {
        uint32_t v = gd__edit_vertex(mesh, i);
        if (v == GD_NONE) continue;
        level->number[v] = count;
        gd__edited_keep(&level->made, count, mesh, v);
        bool is_boundary = mesh->vertex_kind[v] == GD_VERTEX_BOUNDARY;
        if (is_boundary && level->scheme == GD_SUBDIVIDE_LOOP)
            put(level, count, moved_on_boundary(level, v));
        else if (!is_boundary && level->scheme != GD_SUBDIVIDE_MIDPOINT)
            put(level, count, moved_inside(level, v));
        count++;
    }
}

/* --- the new vertices ------------------------------------------------------------------------- */

static struct gd_vec3 edge_point(const struct level *level, uint32_t edge)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t side = 2 * edge;
    struct gd_vec3 middle = gd_vec3_scale(
        gd_vec3_add(mesh->position[mesh->origin[side]], mesh->position[mesh->origin[side + 1]]),
        0.5);
    if (level->scheme == GD_SUBDIVIDE_MIDPOINT || gd__side_is_boundary(mesh, side) ||
        gd__side_is_boundary(mesh, side + 1))
        return middle;
    struct gd_vec3 across = gd_vec3_add(mesh->position[gd__side_apex(mesh, side)],
                                        mesh->position[gd__side_apex(mesh, side + 1)]);
    return gd_vec3_add(gd_vec3_scale(middle, 0.75), gd_vec3_scale(across, 0.125));
}

static void make_edge_points(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    for (uint32_t e = 0; e < mesh->edge_count && gd__pace(&level->pace, 4); e++) {
        const struct gd_point middle = {.kind = GD_POINT_EDGE, .element = e, .weight = {0.5, 0.5}};
        put(level, mesh->vertex_count + e, edge_point(level, e));
        level->made.origins[mesh->vertex_count + e] = gd__origin_of(mesh, &middle);
    }
}

static void make_face_points(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    for (uint32_t f = 0; f < mesh->face_count && gd__pace(&level->pace, 4); f++) {
        struct gd_vec3 sum = {0};
        for (int k = 0; k < 3; k++)
            sum = gd_vec3_add(sum, mesh->position[mesh->origin[mesh->face_side[f][k]]]);
        put(level, mesh->vertex_count + f, gd_vec3_scale(sum, 1.0 / 3));
        level->made.origins[mesh->vertex_count + f] =
            (struct gd_origin){{1.0 / 3, 1.0 / 3, 1.0 / 3}, mesh->index_of_face[f]};
    }
}

/* --- faces ------------------------------------------------------------------------------------ */

static uint32_t *face_put(uint32_t *corner, uint32_t a, uint32_t b, uint32_t c)
{
    corner[0] = a, corner[1] = b, corner[2] = c;
    return corner + 3;
}

/* Divides each face, in the order of indices, into three faces at its corners and one in the
 * middle. */
static void divide_in_four(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t *corner = level->made.polygons.corners;
    for (uint32_t i = 0; i < mesh->summary.face_index_count && gd__pace(&level->pace, 2); i++) {
        uint32_t f = gd__edit_face(mesh, i), old[3], middle[3];
        if (f == GD_NONE) continue;
        for (int k = 0; k < 3; k++) {
            uint32_t side = mesh->face_side[f][k];
            old[k] = level->number[mesh->origin[side]];
            middle[k] = mesh->vertex_count + side / 2;
        }
        for (int k = 0; k < 3; k++)
            corner = face_put(corner, old[k], middle[k], middle[(k + 2) % 3]);
        corner = face_put(corner, middle[0], middle[1], middle[2]);
    }
}

/* Writes the faces of the sqrt(3) scheme. Each interior edge yields two faces, whose corners are
 * the edge's ends and the middles of its two faces. A boundary edge yields one face. */
static void divide_in_three(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    uint32_t *corner = level->made.polygons.corners;
    for (uint32_t e = 0; e < mesh->edge_count && gd__pace(&level->pace, 2); e++) {
        uint32_t side = gd__side_is_boundary(mesh, 2 * e) ? 2 * e + 1 : 2 * e;
        uint32_t a = level->number[mesh->origin[side]];
        uint32_t b = level->number[gd__side_destination(mesh, side)];
        uint32_t left = mesh->vertex_count + mesh->side_face[side];
        if (gd__side_is_boundary(mesh, side ^ 1)) {
            corner = face_put(corner, a, b, left);
            continue;
        }
        uint32_t right = mesh->vertex_count + mesh->side_face[side ^ 1];
        corner = face_put(corner, a, right, left);
        corner = face_put(corner, right, b, left);
    }
}

static enum gd_status level_run(struct level *level)
{
    const struct gd_mesh *mesh = level->mesh;
    bool is_sqrt3 = level->scheme == GD_SUBDIVIDE_SQRT3;
    uint32_t vertices = mesh->vertex_count + (is_sqrt3 ? mesh->face_count : mesh->edge_count);
    uint32_t faces = (is_sqrt3 ? 3 : 4) * mesh->face_count;
    level->number = malloc(mesh->vertex_count * sizeof *level->number);
    enum gd_status status =
        level->number ? gd__edited_allocate(&level->made, vertices, faces) : GD_NO_MEMORY;
    if (status) return status;
    keep_vertices(level);
    if (is_sqrt3) {
        make_face_points(level);
        divide_in_three(level);
    } else {
        make_edge_points(level);
        divide_in_four(level);
    }
    return level->pace.status;
}

enum gd_status gd__subdivide_once(const struct gd_mesh *mesh,
                                  const struct gd_subdivide_options *options,
                                  const struct gd_control *control, struct gd_edited *out,
                                  struct gd_detail *detail)
{
    struct level level = {
        .mesh = mesh, .scheme = options->scheme, .pace = {.control = control, .fraction = 0.5}};
    if (mesh->face_count > GD_EDIT_FACES_MOST / 4)
        return gd_fail(detail, GD_TOO_LARGE, "%u faces are too many to be divided",
                       mesh->face_count);
    enum gd_status status = gd_control_afford(control, 4 * (size_t)mesh->face_count * 64);
    if (!status) status = level_run(&level);
    free(level.number);
    if (status)
        gd_edited_free(&level.made);
    else
        *out = level.made;
    return status;
}
