/* Samples: meshes made by rule, for tests, benchmarks and demonstrations. The same parameters give
 * the same mesh on every run.
 *
 *     struct gd_polygons sphere;
 *     if (sample_icosphere(4, 1.0, &sphere) == GD_OK) { …; gd_polygons_free(&sphere); }
 *
 * Every generator fills `*out` with triangles, counter-clockwise seen from outside (from above),
 * owned by the caller, and returns GD_OK or GD_NO_MEMORY. Parameters must be in the ranges of the
 * table. */
#ifndef TESTS_SAMPLES_SAMPLES_H
#define TESTS_SAMPLES_SAMPLES_H

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"
#include "tests/samples/remesh.h"

/* --- the table -------------------------------------------------------------------------------- */

enum { SAMPLE_PARAMETERS = 7 };

struct sample_parameter {
    const char *name; /* NULL: no more of them */
    double value;     /* the default */
    double least, most;
    bool whole; /* a whole number */
};

struct sample {
    const char *name, *sentence;
    struct sample_parameter parameters[SAMPLE_PARAMETERS];
    /* a value for each parameter */
    enum gd_status (*generate)(const double *values, struct gd_polygons *out);
};

extern const struct sample samples[];
extern const uint32_t sample_count;

/* NULL when there is none of that name. */
const struct sample *sample_find(const char *name);

/* --- the families ----------------------------------------------------------------------------- */

/* Flat rectangle [0,width] x [0,height] of columns x rows cells, two triangles each. */
GD_MUST_USE enum gd_status sample_grid(uint32_t columns, uint32_t rows, double width, double height,
                                       struct gd_polygons *out);

/* Closed box [0,size[k]] with cells[k] cells along axis k. */
GD_MUST_USE enum gd_status sample_box(const double size[3], const uint32_t cells[3],
                                      struct gd_polygons *out);

/* Icosahedron, `level` times subdivided and projected on the sphere: 20 * 4^level faces. */
GD_MUST_USE enum gd_status sample_icosphere(uint32_t level, double radius, struct gd_polygons *out);

/* Torus around the z axis. */
GD_MUST_USE enum gd_status sample_torus(uint32_t columns, uint32_t rows, double major, double minor,
                                        struct gd_polygons *out);

/* A pyramid's mantle: apex (0,0,height), the corners of a regular polygon of that radius in z = 0,
 * open below; each of the flat sectors is cut by `rings` parallels. The apex is the last vertex. */
GD_MUST_USE enum gd_status sample_cone(double radius, double height, uint32_t sectors,
                                       uint32_t rings, struct gd_polygons *out);

/* The same with its apex at the origin and its corners at z = +-amplitude in turn: its flat sectors
 * are congruent, and the apex is a saddle whose total angle exceeds 2 pi. GD_INVALID_ARGUMENT: an
 * odd number of sectors. */
GD_MUST_USE enum gd_status sample_saddle(double radius, double amplitude, uint32_t sectors,
                                         uint32_t rings, struct gd_polygons *out);

/* Rings around an apex, each `ratio` times smaller than the one outside it. Two patches share a rim
 * of radius 1, back to back. Near its apex a patch rises by `bend` times the radius. Places and
 * heights are off by up to `noise` times the radius. */
struct sample_grading {
    uint32_t patches; /* 1 or 2 */
    uint32_t sectors, rings;
    double ratio, bend, noise;
};
GD_MUST_USE enum gd_status sample_graded(const struct sample_grading *grading, uint64_t seed,
                                         struct gd_polygons *out);

/* A prism's mantle around the z axis between z = 0 and z = height, open at both ends. */
GD_MUST_USE enum gd_status sample_cylinder(double radius, double height, uint32_t sides,
                                           uint32_t rings, struct gd_polygons *out);

/* Heights of fractal noise over the unit square of cells x cells. */
GD_MUST_USE enum gd_status sample_terrain(uint32_t cells, double amplitude, uint64_t seed,
                                          struct gd_polygons *out);

/* A slab with two holes, smoothed and bumped: closed, genus 2; 100 cells^2 faces. */
GD_MUST_USE enum gd_status sample_genus2(uint32_t cells, double bump, struct gd_polygons *out);

/* Regular tetrahedron, `level` times subdivided; its four corners are vertices 0 to 3. */
GD_MUST_USE enum gd_status sample_tetrahedron(double edge, uint32_t level, struct gd_polygons *out);

/* A small random surface of about `faces` triangles: a simple one whose edges and faces were split
 * and flipped at random, with faces torn out, and its vertices moved far. Saddles, slivers,
 * boundaries, unreferenced vertices and, where vertices were moved to a coarse lattice, ties all
 * occur. */
GD_MUST_USE enum gd_status sample_tangle(uint32_t faces, uint64_t seed, struct gd_polygons *out);

/* Models like those of the tables in Y.-J. Liu's paper (named below), section 5.2, remeshed in the
 * cube [-1,1]^3: an eight (genus 2), a ball, a pot with its handle (genus 1), and a scan of
 * something with lumps and folds. Also GD_INVALID_ARGUMENT, see sample_remesh. */
GD_MUST_USE enum gd_status sample_eight(const struct remeshing *remeshing, uint64_t seed,
                                        struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_ball(const struct remeshing *remeshing, uint64_t seed,
                                       struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_pot(const struct remeshing *remeshing, uint64_t seed,
                                      struct gd_polygons *out);
GD_MUST_USE enum gd_status sample_scan(const struct remeshing *remeshing, uint64_t seed,
                                       struct gd_polygons *out);

/* The benchmark of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using edge-based
 * data structures", section 5.1: polygonal obstacles in a rectangle, lifted to prisms so high that
 * no shortest path climbs them, so that geodesics between points of the ground are the shortest
 * planar paths round the obstacles. The ground is in z = 0. */
struct sample_obstacles {
    struct gd_polygons mesh;
    uint32_t p, q;   /* mesh vertices of the ground, at the left and the right */
    uint32_t count;  /* obstacles, convex and concave in turn */
    uint32_t *first; /* count + 1 offsets into `corners` */
    /* counter-clockwise; multiples of 2^-20, so that orientations are exact in double */
    double (*corners)[2];
};

/* `level` times subdivided, which changes no distance. */
GD_MUST_USE enum gd_status sample_obstacles(uint32_t count, uint32_t level, uint64_t seed,
                                            struct sample_obstacles *out);
void sample_obstacles_free(struct sample_obstacles *obstacles);

#endif
