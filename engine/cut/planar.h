/* Planar: the constrained Delaunay triangulation of one face (plane/triangulation.h), with the
 * sites in it.
 *
 *     gd__planar_begin(&planar, count): then the caller fills plane.sites and places, first the
 *                                       corners, counter-clockwise
 *     gd__planar_triangulate(&planar): the sites, all different
 *     gd__plane_fix(&planar.plane, a, b) for each segment
 *     gd__plane_improve(&planar.plane)
 *
 * The positions, in the plane of the face, are used only to choose among possible flips: they
 * maximise the least angles, which avoids flat triangles. */
#pragma once

#include "base/budget.h"
#include "mesh/local.h"
#include "plane/triangulation.h"

struct gd__planar { /* The memory is reused from face to face. An all-zero struct is empty. */
    struct gd__plane plane; /* must be the first member */
    struct gd__budget *budget;
    struct gd__pace pace;
    uint32_t site_count;
    struct gd__local *places;
};

void gd__planar_free(struct gd__planar *planar);

/* Makes room for `count` >= 3 sites. Errors: GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__planar_begin(struct gd__planar *planar, uint32_t count);

/* Triangulates the sites. Errors: GD_RUNAWAY (a site lies outside the corners' triangle, or on
 * another site), GD_CANCELLED, GD_DEADLINE. Quadratic time. */
GD_MUST_USE enum gd_status gd__planar_triangulate(struct gd__planar *planar);
