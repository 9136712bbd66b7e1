/* Exact geodesic distances on small meshes in extended or quadruple precision. Windows are those of
 * Chen and Han (1990). They are dropped only if vertex distances prove them useless (S.-Q. Xin and
 * G.-J. Wang, "Improving Chen and Han's algorithm on the discrete geodesic problem", 2009, Theorem
 * 3.2). Windows are never compared with each other, and no path enters a face twice. The solver
 * shares no code with the engine.
 *
 *     struct naive_mesh *mesh = naive_mesh_create(positions, position_count, corners, face_count);
 *     struct naive_field *field = naive_field_solve(mesh, NAIVE_EXTENDED, &source, 1, INFINITY);
 *     long double distance = naive_field_distance(field, &target);
 *
 * A window lies in the plane with its source at the origin. It stores the images of the vertices
 * that limit it, and the edge as a vector. The image of a vertex at a distance of 1e-15 from the
 * source therefore keeps all of its digits. Suitable for some hundred faces. */
#pragma once

#include <stdint.h>

struct naive_mesh;
struct naive_field;

/* NAIVE_EXTENDED has 64 bits of mantissa. NAIVE_QUADRUPLE has 113 bits, and is about 20 times
 * slower. */
enum naive_precision { NAIVE_EXTENDED, NAIVE_QUADRUPLE };

/* A point of a face. The solver replaces the largest weight by 1 minus the other two, so that small
 * weights keep all of their digits. Weights of exactly zero place the point on an edge or a
 * vertex. */
struct naive_point {
    uint32_t face;
    double weight[3];
};

struct naive_source {
    struct naive_point point;
    double offset; /* this is added to every distance from the source */
};

/* Copies a manifold triangle mesh, whose faces may have any orientation. Returns NULL if out of
 * memory. */
struct naive_mesh *naive_mesh_create(const double (*positions)[3], uint32_t position_count,
                                     const uint32_t *corners, uint32_t face_count);
void naive_mesh_free(struct naive_mesh *mesh); /* NULL is allowed */

/* Computes distances from the nearest source. Distances up to `radius`, which may be INFINITY, are
 * exact. Larger distances are upper bounds. The mesh must outlive the field. Returns NULL if out of
 * memory, or if there are more than NAIVE_WINDOWS_MOST windows. */
struct naive_field *naive_field_solve(const struct naive_mesh *mesh, enum naive_precision precision,
                                      const struct naive_source *sources, uint32_t source_count,
                                      long double radius);
void naive_field_free(struct naive_field *field); /* NULL is allowed */

enum { NAIVE_WINDOWS_MOST = 4000000 };

/* Returns the distance of a point, or INFINITY if there is no path. */
long double naive_field_distance(const struct naive_field *field, const struct naive_point *point);
long double naive_field_vertex_distance(const struct naive_field *field, uint32_t vertex);

/* Returns the number of propagated windows. */
uint32_t naive_field_windows(const struct naive_field *field);
