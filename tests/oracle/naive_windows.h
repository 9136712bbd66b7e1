/* Exact geodesic distances on small meshes in extended and in quadruple precision: windows in
 * the manner of Chen and Han (1990), dropped only where vertex distances prove them useless
 * (S.-Q. Xin and G.-J. Wang, "Improving Chen and Han's algorithm on the discrete geodesic
 * problem", 2009, Theorem 3.2). Windows are never compared with each other, no way enters
 * a face twice, and no code is shared with the engine.
 *
 *     struct naive_mesh *mesh = naive_mesh_create(positions, position_count, corners, face_count);
 *     struct naive_field *field = naive_field_solve(mesh, NAIVE_EXTENDED, &source, 1, INFINITY);
 *     long double distance = naive_field_distance(field, &target);
 *
 * A window is laid out in the plane with its source at the origin. Images of vertices that it
 * still touches are kept, and so are edges as vectors: a vertex 1e-15 away from the source has
 * an image with all of its digits. Meant for some hundred faces. */
#ifndef TESTS_ORACLE_NAIVE_WINDOWS_H
#define TESTS_ORACLE_NAIVE_WINDOWS_H

#include <stdint.h>

struct naive_mesh;
struct naive_field;

/* 64 bits of mantissa; 113 bits, some 20 times slower. */
enum naive_precision { NAIVE_EXTENDED, NAIVE_QUADRUPLE };

/* A point of a face. The largest weight is not read: it is what the other two leave of 1. So a
 * point beside a corner is given by its small weights, to their last bit. Weights of exactly
 * zero put it on an edge or a vertex. */
struct naive_point {
    uint32_t face;
    double weight[3];
};

struct naive_source {
    struct naive_point point;
    double offset; /* added to every distance from it */
};

/* A manifold triangle mesh of its own, faces oriented anyhow. NULL: out of memory. */
struct naive_mesh *naive_mesh_create(const double (*positions)[3], uint32_t position_count,
                                     const uint32_t *corners, uint32_t face_count);
void naive_mesh_free(struct naive_mesh *mesh); /* NULL is harmless */

/* Distances from the nearest of the sources. Those up to `radius`, which may be INFINITY, are
 * exact; beyond it they are upper bounds. The mesh must outlive the field. NULL: out of memory,
 * or more than NAIVE_WINDOWS_MOST windows. */
struct naive_field *naive_field_solve(const struct naive_mesh *mesh, enum naive_precision precision,
                                      const struct naive_source *sources, uint32_t source_count,
                                      long double radius);
void naive_field_free(struct naive_field *field); /* NULL is harmless */

enum { NAIVE_WINDOWS_MOST = 4000000 };

/* INFINITY: no path. */
long double naive_field_distance(const struct naive_field *field, const struct naive_point *point);
long double naive_field_vertex_distance(const struct naive_field *field, uint32_t vertex);

/* Windows propagated. */
uint32_t naive_field_windows(const struct naive_field *field);

#endif
