/* Samples: generated meshes for tests, benchmarks and demonstrations. The same parameters give the
 * same mesh on every run.
 *
 *     struct gd_polygons sphere;
 *     if (sample_icosphere(4, 1.0, &sphere) == GD_OK) { …; gd_polygons_free(&sphere); }
 *
 * Every generator writes triangles to *out and returns GD_OK or GD_NO_MEMORY. The caller owns the
 * mesh. Triangles are counter-clockwise seen from outside, or from above. Parameters must be in the
 * ranges of the table. */
#pragma once

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"
#include "tests/samples/remesh.h"

/* --- the table -------------------------------------------------------------------------------- */

enum { SAMPLE_PARAMETERS = 7 };

struct sample_parameter {
    const char *name; /* the name is NULL at the end of the list */
    double value;     /* the default */
    double least, most;
    bool whole; /* an integer */
};

struct sample {
    const char *name, *sentence;
    struct sample_parameter parameters[SAMPLE_PARAMETERS + 1]; /* the last parameter has no name */
    /* `values` has one value for each parameter */
    enum gd_status (*generate)(const double *values, struct gd_polygons *out);
};

extern const struct sample samples[];
extern const uint32_t sample_count;

/* Returns NULL if there is no such sample. */
const struct sample *sample_find(const char *name);

/* --- the families ----------------------------------------------------------------------------- */

/* A flat rectangle [0,width] x [0,height] of columns x rows cells, two triangles each. */
GD_MUST_USE enum gd_status sample_grid(uint32_t columns, uint32_t rows, double width, double height,
                                       struct gd_polygons *out);

/* A closed box [0,size[k]] with cells[k] cells along axis k. */
GD_MUST_USE enum gd_status sample_box(const double size[3], const uint32_t cells[3],
                                      struct gd_polygons *out);

/* An icosahedron, subdivided `level` times and projected onto the sphere: 20 * 4^level faces. */
GD_MUST_USE enum gd_status sample_icosphere(uint32_t level, double radius, struct gd_polygons *out);

/* A torus around the z axis. */
GD_MUST_USE enum gd_status sample_torus(uint32_t columns, uint32_t rows, double major, double minor,
                                        struct gd_polygons *out);

/* A pyramid without base: apex (0,0,height), and the corners of a regular polygon with this radius
 * in z = 0. `rings` parallels divide each flat sector. The apex is the last vertex. */
GD_MUST_USE enum gd_status sample_cone(double radius, double height, uint32_t sectors,
                                       uint32_t rings, struct gd_polygons *out);

/* Like sample_cone, but the apex is at the origin, and the corners are alternately at z =
 * +amplitude and z = -amplitude. The flat sectors are congruent. The apex is a saddle, with a total
 * angle above 2 pi. Returns GD_INVALID_ARGUMENT if the number of sectors is odd. */
GD_MUST_USE enum gd_status sample_saddle(double radius, double amplitude, uint32_t sectors,
                                         uint32_t rings, struct gd_polygons *out);

/* Rings around an apex. Each ring is smaller than the next outer ring by the factor `ratio`. Two
 * patches share a rim of radius 1, back to back. Near its apex a patch rises by `bend` times the
 * radius. Positions and heights have random errors of up to `noise` times the radius. */
struct sample_grading {
    uint32_t patches; /* 1 or 2 */
    uint32_t sectors, rings;
    double ratio, bend, noise;
};
GD_MUST_USE enum gd_status sample_graded(const struct sample_grading *grading, uint64_t seed,
                                         struct gd_polygons *out);

/* A prism around the z axis between z = 0 and z = height, without its two bases. */
GD_MUST_USE enum gd_status sample_cylinder(double radius, double height, uint32_t sides,
                                           uint32_t rings, struct gd_polygons *out);

/* A height field of fractal noise over the unit square, with cells x cells cells. */
GD_MUST_USE enum gd_status sample_terrain(uint32_t cells, double amplitude, uint64_t seed,
                                          struct gd_polygons *out);

/* A smoothed slab with two holes and bumps: closed, genus 2, 100 cells^2 faces. */
GD_MUST_USE enum gd_status sample_genus2(uint32_t cells, double bump, struct gd_polygons *out);

/* A regular tetrahedron, subdivided `level` times. Its four corners are vertices 0 to 3. */
GD_MUST_USE enum gd_status sample_tetrahedron(double edge, uint32_t level, struct gd_polygons *out);

/* A small random surface of about `faces` triangles. A simple surface is changed at random: edges
 * and faces are split, edges are flipped, faces are removed, and vertices are moved far. Saddles,
 * slivers, boundaries and unreferenced vertices occur. In some surfaces vertices are on a coarse
 * lattice, which gives ties. */
GD_MUST_USE enum gd_status sample_tangle(uint32_t faces, uint64_t seed, struct gd_polygons *out);

/* Models like those of the tables in Y.-J. Liu's paper (named below), section 5.2, remeshed in the
 * cube [-1,1]^3: an eight (genus 2), a ball, a pot with a handle (genus 1), and a scan with lumps
 * and folds. These functions can also return GD_INVALID_ARGUMENT, see sample_remesh. */
GD_MUST_USE enum gd_status sample_eight(const struct remeshing *remeshing, uint64_t seed,
                                        struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_ball(const struct remeshing *remeshing, uint64_t seed,
                                       struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_pot(const struct remeshing *remeshing, uint64_t seed,
                                      struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_scan(const struct remeshing *remeshing, uint64_t seed,
                                       struct gd_polygons *out);

/* The benchmark of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using edge-based
 * data structures", section 5.1: polygonal obstacles in a rectangle, raised to prisms so high that
 * no shortest path climbs them. Geodesics between points of the ground, in z = 0, are therefore the
 * shortest planar paths around the obstacles. */
struct sample_obstacles {
    struct gd_polygons mesh;
    uint32_t p, q;   /* vertices of the ground, at the left and at the right */
    uint32_t count;  /* number of obstacles; convex and concave obstacles alternate */
    uint32_t *first; /* count + 1 offsets into `corners` */
    /* counter-clockwise; multiples of 2^-20, so that orientations are exact in double */
    double (*corners)[2];
};

/* `level` is the number of subdivisions, which change no distance. */
GD_MUST_USE enum gd_status sample_obstacles(uint32_t count, uint32_t level, uint64_t seed,
                                            struct sample_obstacles *out);
void sample_obstacles_free(struct sample_obstacles *obstacles);
