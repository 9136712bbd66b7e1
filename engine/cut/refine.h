/* Refined mesh: the mesh after the faces that the curve crosses are divided. The curve's segments
 * are sides of its triangles. Triangles are ordered by the input index of their faces. Neighbouring
 * triangles are joined, except across the seam. Joined triangles form a region. Joined corners are
 * one vertex of the region. */
#pragma once

#include "cut/seam.h"

struct gd__refined {
    const struct gd_mesh *mesh;
    const struct gd__nodes *nodes;
    uint32_t count; /* triangles */
    uint32_t (*node)[3];
    uint32_t *face;    /* for each triangle, the mesh's face that contains it */
    uint32_t *region;  /* union-find forest of joined triangles */
    uint32_t *vertex;  /* union-find forest of joined corners, three for each triangle */
    uint32_t *of_face; /* for each face, its first triangle */
    uint32_t *in_face; /* for each face, the number of its triangles */
};

/* Refines the mesh. Errors: GD_RUNAWAY (a segment cannot be inserted, or a triangle is too flat for
 * a mesh; a larger snap distance may help), GD_INTERNAL (the triangles of a face do not cover it
 * exactly), GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. On failure
 * `*flat_face` is the face that failed. Linear in the mesh; quadratic in the nodes
 * of a face. */
GD_MUST_USE enum gd_status gd__refine(const struct gd__arrangement *arrangement,
                                      const struct gd__seam *seam, struct gd__arena *arena,
                                      struct gd__refined *out, uint32_t *flat_face);

/* Returns a triangle's fraction of the area of its face. */
double gd__refined_share(const struct gd__refined *refined, uint32_t triangle);
