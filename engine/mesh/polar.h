/* Polar coordinates of a point about a vertex of its face: the distance from the vertex, and the
 * angle in the vertex' fan.
 *
 * They are precise for a point close to the vertex. The radius is computed from the small
 * barycentric coordinates, and the angle is as precise as the angles of the fan. A radius and an
 * angle computed from the difference of two positions would be less precise. Normalised unit. */
#pragma once

#include "mesh/local.h"

struct gd__polar {
    uint32_t vertex;
    uint32_t entry; /* entry of mesh->fan whose face contains the point */
    double radius;
    /* from the fan's first entry; between the angles at which the face of `entry` begins and
       ends */
    double angle;
};

/* Computes the polar coordinates of a point about a vertex. Returns false if no face of the vertex
 * contains the point, or if the point is the vertex. O(1). */
bool gd__polar_about(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t vertex,
                     struct gd__polar *out);

/* Computes the polar coordinates of a point about the vertex beside this point. The vertex must be
 * nearer than GD_TOL_BESIDE_VERTEX times the least altitude of its faces. So a ray from the point
 * crosses edges of the vertex only far from their other ends. Returns false if there is no such
 * vertex. O(degree), and O(1) for points in the middle of their face. */
bool gd__polar_beside(const struct gd_mesh *mesh, const struct gd_point *point,
                      struct gd__polar *out);

/* Like gd__polar_beside, for a point whose straight line to another point, around or through the
 * vertex, is sought. `radius` is the distance of the other point from the vertex. The sum of both
 * distances must be at most the distance of the vertex from the opposite side of each of its faces.
 * So the straight line is the shortest path: a path that leaves the faces of the vertex is longer.
 * In narrow faces, points much farther from the vertex than those of gd__polar_beside satisfy
 * this. */
bool gd__polar_around(const struct gd_mesh *mesh, const struct gd_point *point, double radius,
                      struct gd__polar *out);

/* Returns the position of a point in the plane of a fan entry's face. The entry's side lies on the
 * x axis. `turn` is the angle from this side to the point. The point may lie outside the face. */
static inline struct gd__local gd__polar_place(const struct gd__polar *polar, double turn)
{
    return (struct gd__local){polar->radius * cos(turn), polar->radius * sin(turn)};
}

/* Returns the angle at which the face of a fan entry ends. */
static inline double gd__fan_end(const struct gd_mesh *mesh, uint32_t vertex, uint32_t entry)
{
    return entry + 1 < mesh->fan_first[vertex + 1] ? mesh->fan[entry + 1].angle
                                                   : mesh->total_angle[vertex];
}

/* Adds a multiple of 2 pi to the angle, such that the result is nearest to [0, extent]. */
static inline double gd__turn_nearest(double angle, double extent)
{
    return remainder(angle - 0.5 * extent, 2 * M_PI) + 0.5 * extent;
}
