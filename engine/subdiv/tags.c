#include "subdiv/connect.h"

#include <math.h>
#include <stdlib.h>

static float sharpness_of(double sharpness)
{
    return sharpness >= GD_SHARPNESS_INFINITE ? INFINITY : (float)sharpness;
}

static enum gd_status check_tag(const struct gd__net *net, const char *what, uint32_t index,
                                uint32_t vertex, double sharpness, struct gd_detail *detail)
{
    if (vertex >= net->point_count)
        return gd_fail(detail, GD_OUT_OF_RANGE,
                       "%s %u refers to vertex %u, but the mesh has %u vertices, numbered from 0",
                       what, index, vertex, net->point_count);
    if (!(sharpness >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "%s %u has the sharpness %g; a sharpness must be at least 0", what, index,
                       sharpness);
    return GD_OK;
}

static int compare_key(const void *key, const void *edge)
{
    uint64_t a = *(const uint64_t *)key, b = ((const struct gd__edge_key *)edge)->key;
    return (a > b) - (a < b);
}

static enum gd_status apply_crease(const struct gd_crease *crease, uint32_t index,
                                   const struct gd__edge_key *edges, struct gd__net *net,
                                   struct gd_detail *detail)
{
    uint64_t a = crease->vertices[0], b = crease->vertices[1],
             key = a < b ? a << 32 | b : b << 32 | a;
    enum gd_status status =
        check_tag(net, "crease", index, crease->vertices[0], crease->sharpness, detail);
    if (!status)
        status = check_tag(net, "crease", index, crease->vertices[1], crease->sharpness, detail);
    if (status) return status;
    const struct gd__edge_key *edge =
        bsearch(&key, edges, net->side_count, sizeof *edges, compare_key);
    if (!edge) {
        gd_fail(
            detail, GD_NO_SUCH_EDGE,
            "crease %u has the vertices %u and %u, which share no edge; name both ends of an edge",
            index, crease->vertices[0], crease->vertices[1]);
        gd_detail_add(detail, GD_ELEMENT_EDGE, a, b);
        return GD_NO_SUCH_EDGE;
    }
    uint32_t twin = net->twin[edge->side];
    if (twin == GD_NONE) return GD_OK; /* the boundary is already infinitely sharp */
    net->sharpness[edge->side] = net->sharpness[twin] = sharpness_of(crease->sharpness);
    return GD_OK;
}

static enum gd_status apply_corner(const struct gd_corner *corner, uint32_t index,
                                   const uint32_t *faces, struct gd__net *net,
                                   struct gd_detail *detail)
{
    enum gd_status status =
        check_tag(net, "corner", index, corner->vertex, corner->sharpness, detail);
    if (status) return status;
    if (faces[corner->vertex] == 0)
        return gd_fail(detail, GD_UNREFERENCED_VERTEX,
                       "corner %u refers to vertex %u, which belongs to no face; remove the corner",
                       index, corner->vertex);
    net->corner[corner->vertex] = sharpness_of(corner->sharpness);
    return GD_OK;
}

static enum gd_status apply_boundary(enum gd_interpolate_boundary rule, const uint32_t *faces,
                                     struct gd__net *net, struct gd_detail *detail)
{
    for (uint32_t side = 0; side < net->side_count; side++) {
        if (net->twin[side] != GD_NONE) continue;
        if (rule == GD_INTERPOLATE_NONE)
            return gd_fail(
                detail, GD_UNSUPPORTED,
                "the mesh has a boundary edge between vertices %u and %u, where the boundary rule "
                "\"none\" defines no surface; choose edgeOnly or edgeAndCorner",
                net->origin[side], gd__side_end(net, side));
        uint32_t point = net->origin[side];
        if (rule == GD_INTERPOLATE_EDGE_AND_CORNER && faces[point] == 1)
            net->corner[point] = INFINITY;
    }
    return GD_OK;
}

enum gd_status gd__apply_tags(const struct gd_control_mesh *mesh, struct gd__connecting *connecting,
                              struct gd__net *net, struct gd_detail *detail)
{
    uint32_t *faces = gd__arena_zeroed(&connecting->scratch, net->point_count, sizeof *faces);
    if (!faces) return connecting->scratch.status;
    for (uint32_t side = 0; side < net->side_count; side++) faces[net->origin[side]]++;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; !status && i < mesh->crease_count; i++)
        status = apply_crease(&mesh->creases[i], i, connecting->edges, net, detail);
    for (uint32_t i = 0; !status && i < mesh->corner_count; i++)
        status = apply_corner(&mesh->corners[i], i, faces, net, detail);
    return status ? status : apply_boundary(mesh->boundary, faces, net, detail);
}
