/* Zoo: degenerate shapes that often break geodesic programs. Some shapes have no well-defined
 * distances, and the engine must reject them.
 *
 * The comment of each maker function begins with the names of its parameters. `values` has the
 * parameters in this order. Every maker returns GD_OK or GD_NO_MEMORY. */
#pragma once

#include "gd/polygons.h"
#include "gd/status.h"

struct zoo_shape {
    struct gd_polygons mesh;
    /* for each vertex, the position on the unfolded surface, for closed forms; NULL if the surface
       is not folded */
    double (*chart)[3];
    uint32_t centre; /* the vertex at which the shape is degenerate */
    double offset;   /* this is added to each coordinate; subtracting it is exact */
};

typedef enum gd_status zoo_maker(const double *values, struct zoo_shape *out);

void zoo_shape_free(struct zoo_shape *shape);

/* --- refused shapes --------------------------------------------------------------------------- */

zoo_maker zoo_twin_vertices;   /* a grid with two adjacent vertices at one position */
zoo_maker zoo_repeated_corner; /* a face a, a, b */
zoo_maker zoo_duplicate_face;  /* reversed: a triangle and its copy, or its reversed copy */
zoo_maker zoo_three_at_edge;   /* three faces at an edge */
zoo_maker zoo_bow_tie;         /* two fans at a vertex */
zoo_maker zoo_moebius;         /* cells: a band with half a twist */
zoo_maker zoo_not_finite;      /* coordinate: a triangle with this coordinate */

/* --- flat ------------------------------------------------------------------------------------- */

/* height: a quadrilateral in a plane. One of its four triangles has the base 1 and this height. */
zoo_maker zoo_cap;

/* columns, rows, width, slant: planar cells. Each row is shifted by `slant` against the row
 * below. */
zoo_maker zoo_needles;

/* spokes, reach: a regular polygon of radius 1 in a plane, as a fan about a vertex at the distance
 * `reach` from its centre. */
zoo_maker zoo_wheel;

/* columns, rows, width, folds: cells of height 1, folded flat along columns, so that the faces lie
 * on top of each other. */
zoo_maker zoo_accordion;

/* width, height, points per side: two coincident rectangles, joined along their border. In the
 * chart, one rectangle has z > 0, the other z < 0. */
zoo_maker zoo_pillow;

/* --- curved ----------------------------------------------------------------------------------- */

/* radius, height, sides, rings: sample_cylinder. */
zoo_maker zoo_tube;

/* radius, apex, +-z of the corners, sectors: sample_cone if z is 0, otherwise sample_saddle, whose
 * apex is the origin. */
zoo_maker zoo_fan;

/* a, b, c: sample_box with one cell per side. */
zoo_maker zoo_box;

/* x, y, z: an octahedron with these half axes. */
zoo_maker zoo_octahedron;

/* seed, stretch, columns, rows: a grid with about half of its vertices moved by up to 1.5 cells, so
 * that parts of it fold over. The grid is then stretched along x. */
zoo_maker zoo_crumpled;

/* seed, faces, scale, offset: sample_tangle, scaled, then moved along each axis. */
zoo_maker zoo_tangle;

/* seed, ratio: two tangles. The second one is scaled by `ratio`. */
zoo_maker zoo_assembly;

/* columns, length: a fine grid of size 1, and one more face at its side; the tip of this face is at
 * x = length. */
zoo_maker zoo_spike;
