#include "mesh/polar.h"

#include <math.h>

#include "base/tolerance.h"

/* Handles a point of an edge that ends at the vertex. The edge's outgoing side has no face if it is
 * the last side of the fan of a boundary vertex. */
static bool about_end_of_edge(const struct gd_mesh *mesh, const struct gd_point *point,
                              uint32_t vertex, struct gd__polar *out)
{
    uint32_t side = 2 * point->element;
    double part = point->weight[0];
    if (mesh->origin[side] != vertex) {
        side ^= 1;
        part = gd__edge_rest(point);
        if (mesh->origin[side] != vertex) return false;
    }
    bool is_last = gd__side_is_boundary(mesh, side);
    uint32_t entry = is_last ? mesh->fan_first[vertex + 1] - 1 : gd__fan_entry(mesh, side);
    *out =
        (struct gd__polar){.vertex = vertex,
                           .entry = entry,
                           .radius = part * mesh->side[side].length,
                           .angle = is_last ? mesh->total_angle[vertex] : mesh->fan[entry].angle};
    return true;
}

bool gd__polar_about(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t vertex,
                     struct gd__polar *out)
{
    if (point->kind == GD_POINT_VERTEX) return false;
    if (point->kind == GD_POINT_EDGE) return about_end_of_edge(mesh, point, vertex, out);
    const uint32_t *side = mesh->face_side[point->element];
    int k = (mesh->origin[side[1]] == vertex) + 2 * (mesh->origin[side[2]] == vertex);
    if (mesh->origin[side[k]] != vertex) return false;
    uint32_t entry = gd__fan_entry(mesh, side[k]);
    struct gd__local at = gd__side_local(&mesh->side[side[k]], point->weight[(k + 1) % 3],
                                         point->weight[(k + 2) % 3]);
    *out = (struct gd__polar){.vertex = vertex,
                              .entry = entry,
                              .radius = sqrt(at.x * at.x + at.y * at.y),
                              .angle = mesh->fan[entry].angle + atan2(at.y, at.x)};
    return true;
}

/* Returns the least altitude of the faces around a vertex: twice the area over the longest side. */
static double least_altitude(const struct gd_mesh *mesh, uint32_t vertex)
{
    double least = INFINITY;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        const struct gd_side *s = &mesh->side[mesh->fan[i].side];
        double longest = fmax(s->length, fmax(s->left_length, s->right_length));
        least = fmin(least, s->length * s->left_length * s->left_y / longest);
    }
    return least;
}

/* Returns the least distance from a vertex to the opposite sides of its faces. */
static double least_reach(const struct gd_mesh *mesh, uint32_t vertex)
{
    double least = INFINITY;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        const struct gd_side *s = &mesh->side[mesh->fan[i].side];
        double a = s->length, b = s->left_length, opposite = s->right_length;
        /* an angle of 90 degrees or more at an end of the opposite side: this end is nearest */
        bool is_end = a * a + opposite * opposite <= b * b || b * b + opposite * opposite <= a * a;
        least = fmin(least, is_end ? fmin(a, b) : a * b * s->left_y / opposite);
    }
    return least;
}

/* Returns the vertex with the largest weight, or GD_NONE if this weight is not close to 1. */
static uint32_t main_vertex(const struct gd_mesh *mesh, const struct gd_point *point)
{
    const double most = 1 - GD_TOL_BESIDE_VERTEX;
    uint32_t element = point->element;
    if (point->kind == GD_POINT_EDGE) {
        if (point->weight[0] <= GD_TOL_BESIDE_VERTEX) return mesh->origin[2 * element];
        return point->weight[0] >= most ? mesh->origin[2 * element + 1] : GD_NONE;
    }
    for (int k = 0; k < 3 && point->kind == GD_POINT_FACE; k++)
        if (point->weight[k] >= most) return mesh->origin[mesh->face_side[element][k]];
    return GD_NONE;
}

/* Computes the polar coordinates about the vertex with a weight close to 1; returns false if there
 * is none. */
static bool about_main_vertex(const struct gd_mesh *mesh, const struct gd_point *point,
                              struct gd__polar *out)
{
    uint32_t vertex = main_vertex(mesh, point);
    return vertex != GD_NONE && gd__polar_about(mesh, point, vertex, out);
}

bool gd__polar_beside(const struct gd_mesh *mesh, const struct gd_point *point,
                      struct gd__polar *out)
{
    struct gd__polar polar;
    if (!about_main_vertex(mesh, point, &polar)) return false;
    if (polar.radius > GD_TOL_BESIDE_VERTEX * least_altitude(mesh, polar.vertex)) return false;
    *out = polar;
    return true;
}

bool gd__polar_around(const struct gd_mesh *mesh, const struct gd_point *point, double radius,
                      struct gd__polar *out)
{
    struct gd__polar polar;
    if (!about_main_vertex(mesh, point, &polar)) return false;
    if (polar.radius + radius > least_reach(mesh, polar.vertex)) return false;
    *out = polar;
    return true;
}
