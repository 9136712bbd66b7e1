/* Triangulation: constrained Delaunay triangulation of points in the parameter plane
 * (plane/triangulation.h). The segments of closed loops become edges of the triangulation. Points
 * are rounded to a lattice, so all predicates are exact. */
#pragma once

#include "base/pace.h"
#include "loops/lattice.h"

struct gd__triangulation_input {
    const struct gd__site *points; /* within [0, GD__LATTICE_EXTENT] */
    uint32_t count;
    const uint32_t (*segments)[2]; /* constraints: pairs of points */
    uint32_t segment_count;
};

/* The triangles inside the loops: those that are separated from the outside by an odd number of
 * loops. */
struct gd__triangulation {
    uint32_t count;
    uint32_t (*triangles)[3]; /* counter-clockwise; owned */
};

/* Triangulates the points, and selects the triangles inside the loops. Errors: GD_RUNAWAY (segments
 * cross, or a point lies on a segment), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost:
 * about O(points) if consecutive points of the array lie near each other. */
GD_MUST_USE enum gd_status gd__loops_triangulate(const struct gd__triangulation_input *input,
                                                 struct gd__pace *pace,
                                                 struct gd__triangulation *out);
