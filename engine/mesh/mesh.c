/* Lifetime and accessors of a mesh. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/bvh.h"

struct gd_mesh *gd_mesh_retain(const struct gd_mesh *mesh)
{
    gd__references_add(&mesh->references);
    return (struct gd_mesh *)mesh;
}

static void mesh_destroy(struct gd_mesh *mesh)
{
    void *arrays[] = {
        mesh->position,       mesh->total_angle,   mesh->vertex_kind,     mesh->vertex_component,
        mesh->fan_first,      mesh->fan,           mesh->beyond,          mesh->side,
        mesh->origin,         mesh->side_face,     mesh->face_side,       mesh->component,
        mesh->boundary,       mesh->boundary_side, mesh->vertex_of_index, mesh->index_of_vertex,
        mesh->face_of_index,  mesh->index_of_face, mesh->face_flipped,    mesh->source_polygon,
        mesh->input_position, mesh->repair,        mesh->copy_of,
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    gd__bvh_free(mesh->bvh);
    free(mesh);
}

void gd_mesh_release(const struct gd_mesh *mesh)
{
    if (mesh && gd__references_drop(&mesh->references)) mesh_destroy((struct gd_mesh *)mesh);
}

size_t gd_mesh_memsize(const struct gd_mesh *mesh)
{
    return mesh->bytes;
}

const struct gd_mesh_summary *gd_mesh_summary(const struct gd_mesh *mesh)
{
    return &mesh->summary;
}

const struct gd_mesh_repair *gd_mesh_repair(const struct gd_mesh *mesh)
{
    static const struct gd_mesh_repair nothing;
    return mesh->repair ? mesh->repair : &nothing;
}

struct gd_vertex gd_mesh_original(const struct gd_mesh *mesh, struct gd_vertex vertex)
{
    assert(vertex.index < mesh->summary.index_count);
    uint32_t uploaded = mesh->summary.index_count - gd_mesh_repair(mesh)->copies;
    return vertex.index < uploaded ? vertex
                                   : (struct gd_vertex){mesh->copy_of[vertex.index - uploaded]};
}

struct gd_boundary gd_mesh_boundary(const struct gd_mesh *mesh, uint32_t loop)
{
    assert(loop < mesh->summary.boundaries);
    return mesh->boundary[loop];
}

struct gd_vec3 gd_mesh_position(const struct gd_mesh *mesh, struct gd_vertex vertex)
{
    assert(vertex.index < mesh->summary.index_count);
    return mesh->input_position ? mesh->input_position[vertex.index]
                                : gd__vertex_position(mesh, mesh->vertex_of_index[vertex.index]);
}

bool gd_mesh_has_face(const struct gd_mesh *mesh, struct gd_face face)
{
    return face.index < mesh->summary.face_index_count &&
           mesh->face_of_index[face.index] != GD_NONE;
}

void gd_mesh_corners(const struct gd_mesh *mesh, struct gd_face face, struct gd_vertex corners[3])
{
    assert(gd_mesh_has_face(mesh, face));
    const uint32_t *sides = mesh->face_side[mesh->face_of_index[face.index]];
    for (int k = 0; k < 3; k++) corners[k].index = mesh->index_of_vertex[mesh->origin[sides[k]]];
}

uint32_t gd_mesh_source_face(const struct gd_mesh *mesh, struct gd_face face)
{
    assert(face.index < mesh->summary.face_index_count);
    return mesh->source_polygon ? mesh->source_polygon[face.index] : face.index;
}

enum gd_status gd_mesh_polygons(const struct gd_mesh *mesh, struct gd_polygons *out)
{
    struct gd_polygons polygons = {.position_count = mesh->summary.index_count,
                                   .polygon_count = mesh->face_count};
    polygons.positions = malloc(polygons.position_count * sizeof *polygons.positions);
    polygons.corners = malloc(3 * (size_t)polygons.polygon_count * sizeof *polygons.corners);
    if (!polygons.positions || !polygons.corners) {
        gd_polygons_free(&polygons);
        return GD_NO_MEMORY;
    }
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){i});
        memcpy(polygons.positions[i], (double[3]){p.x, p.y, p.z}, sizeof polygons.positions[i]);
    }
    uint32_t *next = polygons.corners;
    for (uint32_t i = 0; i < mesh->summary.face_index_count; i++) {
        struct gd_vertex corners[3];
        if (!gd_mesh_has_face(mesh, (struct gd_face){i})) continue;
        gd_mesh_corners(mesh, (struct gd_face){i}, corners);
        for (int k = 0; k < 3; k++) *next++ = corners[k].index;
    }
    *out = polygons;
    return GD_OK;
}

uint32_t gd__fan_entry(const struct gd_mesh *mesh, uint32_t side)
{
    uint32_t entry = mesh->fan_first[mesh->origin[side]];
    while (mesh->fan[entry].side != side) entry++;
    return entry;
}

uint32_t gd__side_between(const struct gd_mesh *mesh, uint32_t a, uint32_t b)
{
    uint32_t end = mesh->fan_first[a + 1];
    for (uint32_t i = mesh->fan_first[a]; i < end; i++) {
        if (mesh->fan[i].tip == b) return mesh->fan[i].side;
    }
    uint32_t last = mesh->side[mesh->fan[end - 1].side].left;
    return gd__side_destination(mesh, last) == b ? last : GD_NONE;
}
