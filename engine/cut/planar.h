/* Planar: the constrained Delaunay triangulation of one face, its sites and the segments between
 * them.
 *
 *     gd__planar_begin(&planar, count): then the caller fills sites and places, first the
 *                                       corners, counter-clockwise
 *     gd__planar_triangulate(&planar): the sites, none of them twice
 *     gd__planar_fix(&planar, a, b) for each segment
 *     gd__planar_improve(&planar)
 *
 * DESIGN. Which triangles there are is decided by exact turns of the sites alone, so that every one
 * is counter-clockwise and they tile the face whatever rounding does. The places, in the plane of
 * the face, only choose among the possible flips: they make the least angles as large as can be
 * (Lawson 1977), which keeps triangles from being flat. Segments come in by flips of the edges that
 * they cross (Sloan 1993). */
#ifndef GD_CUT_PLANAR_H
#define GD_CUT_PLANAR_H

#include <stdbool.h>

#include "base/budget.h"
#include "cut/lattice.h"
#include "mesh/local.h"

struct gd__planar_triangle {
    uint32_t corner[3]; /* counter-clockwise */
    uint32_t across[3]; /* across the side from corner k to corner k + 1; GD_NONE: none */
    bool is_fixed[3];   /* that side is a segment */
};

struct gd__planar { /* all zero: empty. Kept from face to face */
    struct gd__budget *budget;
    uint32_t site_count, site_capacity, triangle_count;
    struct gd__site *sites;
    struct gd__local *places;
    uint32_t *triangle_at; /* per site: a triangle that has it as a corner */
    struct gd__planar_triangle *triangles;
    struct gd__planar_side *queue; /* of sides that wait for a flip */
};

void gd__planar_free(struct gd__planar *planar);

/* Room for `count` sites, at least 3 of them. GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__planar_begin(struct gd__planar *planar, uint32_t count);

/* A triangulation of the sites. GD_RUNAWAY: one of them lies outside the corners' triangle, or on
 * another; GD_CANCELLED, GD_DEADLINE. Quadratic. */
GD_MUST_USE enum gd_status gd__planar_triangulate(struct gd__planar *planar);

/* Makes the segment between two sites a side of triangles. GD_RUNAWAY: it passes a site, or crosses
 * another segment. */
GD_MUST_USE enum gd_status gd__planar_fix(struct gd__planar *planar, uint32_t a, uint32_t b);

/* Flips what is no segment until the triangulation is Delaunay. */
void gd__planar_improve(struct gd__planar *planar);

#endif
