#include "edit/edited.h"

#include <stdlib.h>

#include "base/slices.h"
#include "mesh/topology.h"

/* --- reading ---------------------------------------------------------------------------------- */

struct gd__edit_counts gd__edit_counts(const struct gd_mesh *mesh)
{
    return (struct gd__edit_counts){mesh->vertex_count, mesh->edge_count, mesh->face_count,
                                    mesh->summary.index_count, mesh->summary.face_index_count};
}

/* Returns the boundary side that begins at a boundary vertex. */
static uint32_t leaving_the_boundary(const struct gd_mesh *mesh, uint32_t vertex)
{
    return gd__side_previous(mesh, mesh->fan[mesh->fan_first[vertex + 1] - 1].side) ^ 1;
}

struct gd__edit_side gd__edit_side(const struct gd_mesh *mesh, uint32_t side)
{
    uint32_t destination = gd__side_destination(mesh, side);
    if (gd__side_is_boundary(mesh, side))
        return (struct gd__edit_side){destination, leaving_the_boundary(mesh, destination),
                                      GD_NONE};
    return (struct gd__edit_side){destination, gd__side_next(mesh, side), mesh->side_face[side]};
}

uint32_t gd__edit_leaving(const struct gd_mesh *mesh, uint32_t vertex)
{
    return mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY
               ? leaving_the_boundary(mesh, vertex)
               : mesh->fan[mesh->fan_first[vertex]].side;
}

uint32_t gd__edit_first_side(const struct gd_mesh *mesh, uint32_t face)
{
    return mesh->face_side[face][0];
}

uint32_t gd__edit_vertex(const struct gd_mesh *mesh, uint32_t index)
{
    uint32_t vertex = mesh->vertex_of_index[index];
    return vertex != GD_NONE && mesh->index_of_vertex[vertex] == index ? vertex : GD_NONE;
}

uint32_t gd__edit_face(const struct gd_mesh *mesh, uint32_t index)
{
    return mesh->face_of_index[index];
}

double gd__edit_box_size(const struct gd_mesh *mesh)
{
    struct gd_vec3 size = gd_vec3_sub(mesh->summary.max, mesh->summary.min);
    return fmax(fmax(size.x, size.y), size.z);
}

struct gd_vec3 gd__edit_place(const struct gd_mesh *mesh, uint32_t vertex)
{
    struct gd_vec3 low = gd_vec3_scale(mesh->summary.min, 1 / mesh->unit);
    return gd_vec3_scale(gd_vec3_sub(mesh->position[vertex], low),
                         mesh->unit / gd__edit_box_size(mesh));
}

/* --- results ---------------------------------------------------------------------------------- */

void gd_edited_free(struct gd_edited *edited)
{
    if (!edited) return;
    gd_polygons_free(&edited->polygons);
    free(edited->origins);
    gd_mesh_release(edited->mesh);
    *edited = (struct gd_edited){0};
}

enum gd_status gd__edited_allocate(struct gd_edited *edited, uint32_t vertices, uint32_t faces)
{
    struct gd_polygons *polygons = &edited->polygons;
    *edited = (struct gd_edited){0};
    polygons->positions = malloc(vertices * sizeof *polygons->positions);
    polygons->corners = malloc(3 * (size_t)faces * sizeof *polygons->corners);
    edited->origins = malloc(vertices * sizeof *edited->origins);
    if (!polygons->positions || !polygons->corners || !edited->origins) {
        gd_edited_free(edited);
        return GD_NO_MEMORY;
    }
    polygons->position_count = vertices;
    polygons->polygon_count = faces;
    edited->bytes = vertices * (sizeof *polygons->positions + sizeof *edited->origins) +
                    3 * (size_t)faces * sizeof *polygons->corners;
    return GD_OK;
}

struct gd_origin gd__origin_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    struct gd_point_description description;
    gd_point_describe(mesh, point, &description);
    const double *w = description.barycentric;
    return (struct gd_origin){{w[0], w[1], w[2]}, description.face.index};
}

void gd__edited_keep(struct gd_edited *edited, uint32_t at, const struct gd_mesh *mesh,
                     uint32_t vertex)
{
    const struct gd_point point = {.kind = GD_POINT_VERTEX, .element = vertex};
    const struct gd_vec3 p = gd__vertex_position(mesh, vertex);
    memcpy(edited->polygons.positions[at], &p, sizeof p);
    edited->origins[at] = gd__origin_of(mesh, &point);
}

struct copying {
    struct gd_edited *edited;
    const struct gd_mesh *mesh;
    const uint32_t *number;
};

/* Copies vertices in internal order, because they lie close together in memory. */
static void copy_vertices(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct copying *copying = context;
    for (uint32_t v = begin; v < end && gd__pace(pace, 7); v++)
        gd__edited_keep(copying->edited, copying->number[v], copying->mesh, v);
}

void gd__edited_copy(struct gd_edited *edited, const struct gd_mesh *mesh, uint32_t *number,
                     struct gd__pace *pace)
{
    struct copying copying = {edited, mesh, number};
    uint32_t *corner = edited->polygons.corners, count = 0;
    for (uint32_t i = 0; i < mesh->summary.index_count && gd__pace(pace, 1); i++) {
        uint32_t v = gd__edit_vertex(mesh, i);
        if (v != GD_NONE) number[v] = count++;
    }
    if (pace->status) return;
    gd__slices_run(pace, mesh->vertex_count, copy_vertices, &copying);
    for (uint32_t i = 0; i < mesh->summary.face_index_count && gd__pace(pace, 1); i++) {
        uint32_t f = gd__edit_face(mesh, i);
        if (f == GD_NONE) continue;
        for (int k = 0; k < 3; k++) *corner++ = number[mesh->origin[mesh->face_side[f][k]]];
    }
}

size_t gd_edit_cost(uint64_t faces)
{
    /* OpenMesh's arrays, the quadrics and the heap take 130 bytes a face. The result and the mesh
     * for the measurement take the rest. */
    return (size_t)(faces * 150) + gd_mesh_build_cost(faces / 2, faces / 4) + ((size_t)1 << 16);
}
