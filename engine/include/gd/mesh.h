/* Mesh: an immutable triangulated 2-manifold, with or without boundary, of one or more components.
 *
 *     struct gd_mesh *mesh;
 *     if (gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail) == GD_OK) {
 *         printf("genus %lld\n", (long long)gd_mesh_summary(mesh)->genus);
 *         gd_mesh_release(mesh);
 *     }
 *
 * Contract of the engine's whole surface: coordinates and distances are in the caller's length unit, angles in radians; faces run counter-
 * clockwise seen from outside; indices are zero-based; numbers are IEEE doubles. Vertices are named by their index in the input, faces by
 * their position after triangulation (a polygon's triangles stand together). "Exact" means: on the polyhedron itself, up to rounding, with
 * a relative error of distances of at most 1e-9 (1e-12 is usual).
 *
 * A mesh is immutable once built: any number of threads may read it. Counts of references are atomic. */
#ifndef GD_MESH_H
#define GD_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"
#include "gd/vec.h"

struct gd_mesh;

/* Named by input index, so that a vertex can't be passed as a face. */
struct gd_vertex {
    uint32_t index;
};
struct gd_face {
    uint32_t index;
};

struct gd_mesh_options {
    bool refuse_polygons; /* GD_NOT_TRIANGLES instead of triangulating */
};

/* Builds a mesh from polygons (borrowed for the call). `options`, `control` and `detail` may be NULL.
 *
 * Polygons of up to 4096 corners are triangulated by diagonals that are not already edges of the mesh; orientation is made consistent in each
 * component (the majority of its faces keeps theirs); vertices that no face uses keep their index.
 *
 * Errors, each with the first offending elements in `detail`: GD_EMPTY, GD_INDEX, GD_NON_FINITE, GD_EXTENT (coordinates or extents beyond
 * 1e+-150, or edges and coordinates that differ from the mean edge by more than 1e75), GD_DEGENERATE_FACE (a repeated vertex, an edge of length
 * zero, or three corners on one line: a height of less than 1e-8 of the longest edge, across which distances could not be trusted),
 * GD_DUPLICATE_FACE, GD_NON_MANIFOLD_EDGE, GD_NON_MANIFOLD_VERTEX, GD_NON_ORIENTABLE, GD_NOT_TRIANGLES, GD_NOT_TRIANGULABLE, GD_UNSUPPORTED
 * (a polygon of more than 4096 corners), GD_TOO_LARGE (more than 2^30 triangles), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * Cost: expected O(n) time and about 500 bytes a face while building. The caller owns one reference of `*out`. */
GD_MUST_USE enum gd_status gd_mesh_build(const struct gd_polygons *polygons, const struct gd_mesh_options *options,
                                         const struct gd_control *control, struct gd_mesh **out,
                                         struct gd_detail *detail);

/* Upper bound of the bytes that building a mesh of so many faces and vertices takes, the mesh itself included. */
size_t gd_mesh_build_cost(uint64_t faces, uint64_t vertices);

struct gd_mesh *gd_mesh_retain(const struct gd_mesh *mesh);
void gd_mesh_release(const struct gd_mesh *mesh); /* NULL is harmless */
size_t gd_mesh_memsize(const struct gd_mesh *mesh);

struct gd_mesh_summary {
    uint32_t index_count; /* vertices of the input, the unreferenced ones included */
    uint32_t vertices;    /* referenced ones */
    uint32_t faces;       /* triangles */
    uint32_t edges;
    uint32_t components;
    uint32_t boundaries; /* boundary loops */
    uint32_t unreferenced_vertices;
    uint32_t saddle_vertices;  /* interior, total angle > 2 pi */
    uint32_t degenerate_faces; /* nearly: height less than 1e-6 of the longest edge; answered, but worth mending */
    uint32_t flipped_faces;    /* turned over to make the orientation consistent */
    int64_t euler_characteristic;
    int64_t genus; /* sum over the components */
    double area;
    struct gd_vec3 min, max; /* bounding box of the referenced vertices */
    struct {
        double min, mean, max;
    } edge_length;
};

/* Borrowed from the mesh, valid as long as it. */
const struct gd_mesh_summary *gd_mesh_summary(const struct gd_mesh *mesh);

struct gd_boundary {
    uint32_t vertices; /* and as many edges */
    double length;
};

/* The loop-th boundary loop, loop < summary.boundaries, in order of the lowest vertex index on each. */
struct gd_boundary gd_mesh_boundary(const struct gd_mesh *mesh, uint32_t loop);

/* Position of a vertex as it was in the input (to the last bit), also for unreferenced ones. vertex.index < index_count. */
struct gd_vec3 gd_mesh_position(const struct gd_mesh *mesh, struct gd_vertex vertex);

/* The three corners of a face: corner 0 as in the input, 1 and 2 exchanged when the face was turned over to make the orientation consistent.
 * Barycentric coordinates are always by the input's order. */
void gd_mesh_corners(const struct gd_mesh *mesh, struct gd_face face, struct gd_vertex corners[3]);

/* Index of the input polygon that the triangle came from. */
uint32_t gd_mesh_source_face(const struct gd_mesh *mesh, struct gd_face face);

/* The triangles as polygons of their own (owned by the caller): all index_count positions, faces as gd_mesh_corners. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_mesh_polygons(const struct gd_mesh *mesh, struct gd_polygons *out);

#endif
