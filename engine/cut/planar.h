/* Planar: the constrained Delaunay triangulation of one face, with the sites in it and the segments
 * between sites.
 *
 *     gd__planar_begin(&planar, count): then the caller fills sites and places, first the
 *                                       corners, counter-clockwise
 *     gd__planar_triangulate(&planar): the sites, all different
 *     gd__planar_fix(&planar, a, b) for each segment
 *     gd__planar_improve(&planar)
 *
 * DESIGN. Exact orientations of the sites alone determine the possible triangles. Therefore every
 * triangle is counter-clockwise and the triangles tile the face, regardless of rounding. The
 * places, in the plane of the face, are used only to choose among possible flips: they maximise the
 * least angles (Lawson 1977), which avoids flat triangles. Segments are inserted by flips of the
 * edges that they cross (Sloan 1993). */
#ifndef GD_CUT_PLANAR_H
#define GD_CUT_PLANAR_H

#include <stdbool.h>

#include "base/budget.h"
#include "cut/lattice.h"
#include "mesh/local.h"

struct gd__planar_triangle {
    uint32_t corner[3]; /* counter-clockwise */
    /* for each side k (from corner k to corner k + 1), the triangle across this side, or GD_NONE if
       there is none */
    uint32_t across[3];
    bool is_fixed[3]; /* for each side, true if it is a segment */
};

struct gd__planar { /* The memory is reused from face to face. An all-zero struct is empty. */
    struct gd__budget *budget;
    uint32_t site_count, site_capacity, triangle_count;
    struct gd__site *sites;
    struct gd__local *places;
    uint32_t *triangle_at; /* for each site, a triangle of which it is a corner */
    struct gd__planar_triangle *triangles;
    struct gd__planar_side *queue; /* queue of sides to be flipped */
};

/* Returns the corner of a triangle after corner k. */
static inline uint32_t gd__corner_after(uint32_t k)
{
    return k == 2 ? 0 : k + 1;
}

void gd__planar_free(struct gd__planar *planar);

/* Makes room for `count` >= 3 sites. Errors: GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__planar_begin(struct gd__planar *planar, uint32_t count);

/* Triangulates the sites. Errors: GD_RUNAWAY (a site lies outside the corners' triangle, or on
 * another site), GD_CANCELLED, GD_DEADLINE. Quadratic time. */
GD_MUST_USE enum gd_status gd__planar_triangulate(struct gd__planar *planar);

/* Changes the triangulation such that the segment between two sites is a side of triangles. Error:
 * GD_RUNAWAY (the segment passes a site, or crosses another segment). */
GD_MUST_USE enum gd_status gd__planar_fix(struct gd__planar *planar, uint32_t a, uint32_t b);

/* Flips sides that are not segments until the triangulation is Delaunay. */
void gd__planar_improve(struct gd__planar *planar);

#endif
