/* Refined: the mesh with the curve drawn in. All triangles, in order of the input index of the face
 * that they lie in; those of crossed faces replaced by smaller ones. Where the seam runs, triangles
 * are not joined: joined ones make a region, joined corners are one vertex of it. */
#ifndef GD_CUT_REFINE_H
#define GD_CUT_REFINE_H

#include "cut/seam.h"

struct gd__refined { /* all zero: none */
    const struct gd_mesh *mesh;
    const struct gd__nodes *nodes;
    uint32_t count; /* triangles */
    uint32_t (*node)[3];
    uint32_t *face;    /* the mesh's face that each lies in */
    uint32_t *region;  /* union-find: joined triangles */
    uint32_t *vertex;  /* union-find: joined corners, 3 a triangle */
    uint32_t *of_face; /* per face its first triangle */
    uint32_t *in_face; /* per face how many it has */
};

/* GD_RUNAWAY (segments that can't be drawn, or triangles flatter than a mesh may have: a larger
 * snap may help), GD_INTERNAL (triangles that do not tile their face), GD_TOO_LARGE, GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. On failure nothing is held, and `*flat_face` is the face at
 * which it ended. Linear in the mesh; quadratic in the nodes of a face. */
GD_MUST_USE enum gd_status gd__refine(const struct gd__arrangement *arrangement,
                                      const struct gd__seam *seam, struct gd__refined *out,
                                      uint32_t *flat_face);
void gd__refined_free(struct gd__refined *refined); /* of one that is all zero: harmless */

/* A triangle's part of the area of its face: those of a face sum to 1. */
double gd__refined_share(const struct gd__refined *refined, uint32_t triangle);

#endif
