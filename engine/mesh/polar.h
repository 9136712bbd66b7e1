/* Polar coordinates of a point about a vertex of its face: the distance from the vertex, and the
 * direction as an angle in the vertex' fan.
 *
 * A point beside a vertex keeps its relative position: the radius is made of barycentric
 * coordinates that are small, and the angle has the precision of the fan's. Differences of
 * coordinates in a face would lose both. Inside unit. */
#ifndef GD_MESH_POLAR_H
#define GD_MESH_POLAR_H

#include "mesh/local.h"

struct gd__polar {
    uint32_t vertex;
    uint32_t entry; /* of mesh->fan: the face that the point lies in, or on whose border it lies */
    double radius;
    double angle; /* from the fan's first entry; within the entry's face */
};

/* The polar coordinates of a point about a vertex. False: no face of the vertex holds the point, or
 * the point is the vertex. O(1). */
bool gd__polar_about(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t vertex,
                     struct gd__polar *out);

/* The polar coordinates of a point about the vertex that it is beside: the vertex is nearer than
 * GD_TOL_BESIDE_VERTEX of the least altitude of its faces, so that every ray from the point crosses
 * the vertex' edges well before their other ends. False: there is no such vertex. O(degree), and
 * O(1) for points that lie in the middle of their face. */
bool gd__polar_beside(const struct gd_mesh *mesh, const struct gd_point *point,
                      struct gd__polar *out);

/* The place of a point in the plane of a fan entry's face, whose side runs from the vertex along
 * the x axis: `turn` is the angle from that side to the point, on either side of the face. */
static inline struct gd__local gd__polar_place(const struct gd__polar *polar, double turn)
{
    return (struct gd__local){polar->radius * cos(turn), polar->radius * sin(turn)};
}

/* The angle at which the face of a fan entry ends. */
static inline double gd__fan_end(const struct gd_mesh *mesh, uint32_t vertex, uint32_t entry)
{
    return entry + 1 < mesh->fan_first[vertex + 1] ? mesh->fan[entry + 1].angle
                                                   : mesh->total_angle[vertex];
}

#endif
