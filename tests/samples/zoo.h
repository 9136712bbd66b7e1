/* Zoo: degenerate shapes made by rule, those that break geodesic programs. Some of them are no
 * surface that distances can be trusted on, and have to be refused.
 *
 * `values` are the numbers that each shape's comment names. Every maker returns GD_OK or
 * GD_NO_MEMORY. */
#ifndef TESTS_SAMPLES_ZOO_H
#define TESTS_SAMPLES_ZOO_H

#include "gd/polygons.h"
#include "gd/status.h"

struct zoo_shape {
    struct gd_polygons mesh;
    /* per vertex where it lies on the surface laid flat, for closed forms; NULL: its position */
    double (*chart)[3];
    uint32_t centre; /* the vertex about which the shape is degenerate */
    double offset;   /* by which each coordinate was moved; taking it off again is exact */
};

typedef enum gd_status zoo_maker(const double *values, struct zoo_shape *out);

void zoo_shape_free(struct zoo_shape *shape);

/* --- to be refused ---------------------------------------------------------------------------- */

zoo_maker zoo_twin_vertices;   /* a grid, two neighbours of which have the same position */
zoo_maker zoo_repeated_corner; /* a face a, a, b */
zoo_maker zoo_duplicate_face;  /* reversed: a triangle, and again, as it is or turned over */
zoo_maker zoo_three_at_edge;   /* three faces at an edge */
zoo_maker zoo_bow_tie;         /* two fans at a vertex */
zoo_maker zoo_moebius;         /* cells: a band with half a twist */
zoo_maker zoo_not_finite;      /* coordinate: a triangle that has it */

/* --- flat ------------------------------------------------------------------------------------- */

/* height: a quadrilateral in the plane; one of its four triangles has a base of 1 and that
 * height. */
zoo_maker zoo_cap;

/* columns, rows, width, slant: cells in the plane, each row moved by `slant` against the one
 * below. */
zoo_maker zoo_needles;

/* spokes, reach: a regular polygon of radius 1 in the plane, a fan round a vertex at that distance
 * from its middle. */
zoo_maker zoo_wheel;

/* columns, rows, width, folds: cells of height 1, folded onto themselves along columns: the faces
 * lie upon each other. */
zoo_maker zoo_accordion;

/* width, height, points a side: two rectangles upon each other, joined at the rim; chart: z > 0
 * above, < 0 below. */
zoo_maker zoo_pillow;

/* --- curved ----------------------------------------------------------------------------------- */

/* radius, height, sides, rings: sample_cylinder. */
zoo_maker zoo_tube;

/* radius, apex, +-z of the corners, sectors: sample_cone, or sample_saddle with the apex at 0. */
zoo_maker zoo_fan;

/* a, b, c: sample_box with one cell a side. */
zoo_maker zoo_box;

/* x, y, z: an octahedron with those half axes. */
zoo_maker zoo_octahedron;

/* seed, stretch, columns, rows: a grid, half of whose vertices are moved by up to one and a half
 * cells, so that parts of it are folded over; then stretched along x. */
zoo_maker zoo_crumpled;

/* seed, faces, scale, offset: sample_tangle scaled, then moved along each axis. */
zoo_maker zoo_tangle;

/* seed, ratio: two tangles, the second one so much smaller. */
zoo_maker zoo_assembly;

/* columns, length: a fine grid of size 1, with one face beside it that reaches so far. */
zoo_maker zoo_spike;

#endif
