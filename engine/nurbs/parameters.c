/* Conversion between parameters of a surface and points of its tessellation. */
#include "nurbs/tessellation.h"

#include <math.h>
#include <string.h>

void gd_tessellation_vertex(const struct gd_tessellation *tessellation, struct gd_vertex vertex,
                            double uv[2])
{
    gd__node_parameters(tessellation, tessellation->node_of[vertex.index], uv);
}

/* If a corner lies at a pole, its parameter along the pole is undefined. Sets it to the weighted
 * mean of the parameters of the other two corners. */
static void settle_poles(const struct gd_parametric *surface, const double weight[3],
                         double uv[3][2])
{
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3; i++) {
            if (!gd__surface_pole(surface, k, uv[i][k])) continue;
            int a = (i + 1) % 3, b = (i + 2) % 3;
            double sum = weight[a] + weight[b], part = sum > 0 ? weight[b] / sum : 0.5;
            uv[i][1 - k] = uv[a][1 - k] + part * (uv[b][1 - k] - uv[a][1 - k]);
        }
    }
}

void gd_tessellation_parameters(const struct gd_tessellation *tessellation,
                                const struct gd_point *point, double uv[2])
{
    struct gd_point_description at;
    gd_point_describe(tessellation->mesh, point, &at);
    const uint32_t *nodes = tessellation->corners[at.face.index];
    double corner[3][2];
    for (int i = 0; i < 3; i++) gd__node_parameters(tessellation, nodes[i], corner[i]);
    settle_poles(tessellation->surface, at.barycentric, corner);
    for (int k = 0; k < 2; k++)
        uv[k] = at.barycentric[0] * corner[0][k] + at.barycentric[1] * corner[1][k] +
                at.barycentric[2] * corner[2][k];
}

/* Computes the barycentric coordinates of the place `at` in the parameter triangle `corner`. */
static void barycentric(const double corner[3][2], const double at[2], double weight[3])
{
    double ax = corner[1][0] - corner[0][0], ay = corner[1][1] - corner[0][1];
    double bx = corner[2][0] - corner[0][0], by = corner[2][1] - corner[0][1];
    double px = at[0] - corner[0][0], py = at[1] - corner[0][1], area = ax * by - ay * bx;
    weight[1] = (px * by - py * bx) / area;
    weight[2] = (ax * py - ay * px) / area;
    weight[0] = 1 - weight[1] - weight[2];
}

/* Computes barycentric coordinates in the single triangle of a cell at a pole. The apex of this
 * triangle represents the whole border of the cell at the pole. */
static void barycentric_at_pole(const struct gd_parametric *surface, const double corner[3][2],
                                const double at[2], double weight[3])
{
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3; i++) {
            if (!gd__surface_pole(surface, k, corner[i][k])) continue;
            int a = (i + 1) % 3, b = (i + 2) % 3;
            double from_pole = (at[k] - corner[i][k]) / (corner[a][k] - corner[i][k]);
            double along = (at[1 - k] - corner[a][1 - k]) / (corner[b][1 - k] - corner[a][1 - k]);
            weight[i] = 1 - from_pole;
            weight[a] = from_pole * (1 - along);
            weight[b] = from_pole * along;
        }
    }
}

static double least(const double weight[3])
{
    return fmin(weight[0], fmin(weight[1], weight[2]));
}

/* Computes the barycentric coordinates of a place in a face. */
static void weigh(const struct gd_tessellation *t, uint32_t face, bool is_at_pole,
                  const double at[2], double weight[3])
{
    double corner[3][2];
    for (int k = 0; k < 3; k++) gd__node_parameters(t, t->corners[face][k], corner[k]);
    if (is_at_pole)
        barycentric_at_pole(t->surface, (const double(*)[2])corner, at, weight);
    else
        barycentric((const double(*)[2])corner, at, weight);
}

/* A place lies in one of the two faces of its cell, or in the single face of a cell at a pole. On a
 * trimmed surface, all faces are tried. A place between a loop and the chords of the loop's samples
 * lies in no face. For such a place, the result is the nearest point of the best face. */
enum gd_status gd_tessellation_point(const struct gd_tessellation *tessellation, double u, double v,
                                     struct gd_point *out, struct gd_detail *detail)
{
    const struct gd_tessellation *t = tessellation;
    if (!gd_parametric_contains(t->surface, u, v))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "(%.17g, %.17g) lies outside the surface's domain", u, v);
    double at[2] = {gd__axis_wrap(t->surface->axis[0], u), gd__axis_wrap(t->surface->axis[1], v)},
           best[3] = {-INFINITY, -INFINITY, -INFINITY}, weight[3], part, sum = 0;
    bool is_trimmed = t->node_uv != NULL;
    uint32_t first = 0, end = t->polygons.polygon_count, face;
    if (!is_trimmed) {
        uint32_t cell = gd__grid_step(&t->grid, 0, at[0], &part) * t->grid.steps[1] +
                        gd__grid_step(&t->grid, 1, at[1], &part);
        first = t->first_face[cell], end = t->first_face[cell + 1];
    }
    face = first;
    for (uint32_t f = first; f < end && !(is_trimmed && least(best) >= 0); f++) {
        weigh(t, f, !is_trimmed && end - first == 1, at, weight);
        if (!(least(weight) > least(best))) continue;
        memcpy(best, weight, sizeof best);
        face = f;
    }
    for (int k = 0; k < 3; k++) sum += best[k] = fmax(best[k], 0);
    for (int k = 0; k < 3; k++) best[k] /= sum;
    return gd_point_in_face(t->mesh, (struct gd_face){face}, best, out, detail);
}
