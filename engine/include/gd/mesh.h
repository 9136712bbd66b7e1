/* Mesh: an immutable triangulated 2-manifold, with or without boundary, of one or more components.
 *
 *     struct gd_mesh *mesh;
 *     if (gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail) == GD_OK) {
 *         printf("genus %lld\n", (long long)gd_mesh_summary(mesh)->genus);
 *         gd_mesh_release(mesh);
 *     }
 *
 * Conventions of all functions of the engine: coordinates and distances are in the caller's length
 * unit, angles in radians; faces are counter-clockwise seen from outside; indices are zero-based;
 * numbers are IEEE doubles. The number of a vertex is its index in the input. The number of a face
 * is its position after triangulation; the triangles of a polygon are consecutive. "Exact" means:
 * on the polyhedron itself, up to rounding, with a relative error of distances of at most 1e-9
 * (1e-14 is usual). Exception: near faces more than 1e5 times as long as wide, the error of
 * distances below 1e-6 of the faces' length is at most 1e-15 of this length.
 *
 * A mesh is immutable: any number of threads may read it. Reference counts are atomic. */
#ifndef GD_MESH_H
#define GD_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

struct gd_mesh;

/* Indices of vertices and faces have different types, so that a vertex cannot be passed as a
 * face. */
struct gd_vertex {
    uint32_t index;
};
struct gd_face {
    uint32_t index;
};

/* If all members are zero, polygons are triangulated, nothing is welded, and non-manifold input is
 * rejected. */
struct gd_mesh_options {
    /* if true, polygons are not triangulated, and the build fails with GD_NOT_TRIANGLES */
    bool refuse_polygons;
    bool repair_split; /* if true, a non-manifold input is repaired, see struct gd_mesh_repair */
    /* if true, vertices within `weld_tolerance` of each other are merged, whether or not a face
       joins them */
    bool weld;
    double weld_tolerance; /* a length >= 0; 0 merges only vertices at the same position */
    /* elements that the reader skipped, which are copied to gd_mesh_repair; borrowed for the call;
       NULL means none */
    const struct gd_mended *lines_skipped;
};

/* Builds a mesh from polygons (borrowed for the call). `options`, `control` and `detail` may be
 * NULL. The caller owns one reference of `*out`.
 *
 * Polygons of up to 4096 corners are triangulated by diagonals that are not yet edges of the mesh.
 * If the orientation of a component is inconsistent, some of its faces are flipped, at most half of
 * them. Vertices that no face uses keep their index.
 *
 * Weld: the vertices of faces are visited in order of index. Each vertex is merged into the vertex
 * with the lowest number among those that are within the tolerance and not merged themselves. So no
 * vertex moves by more than the tolerance, and a chain of close vertices does not collapse into
 * one. The index of a merged vertex then refers to the vertex into which it was merged. Faces that
 * become degenerate or equal are removed, see struct gd_mesh_repair. If the weld makes an edge or a
 * vertex non-manifold, the build fails; with repair_split, the edge or vertex is cut instead.
 *
 * Repair: see struct gd_mesh_repair. A non-orientable component is rejected even with repair.
 *
 * Errors, each with the first offending elements in `detail`: GD_INVALID_ARGUMENT (an invalid weld
 * tolerance, or one below the rounding of the coordinates), GD_EMPTY (also if weld and repair
 * remove all faces), GD_INDEX, GD_NON_FINITE, GD_EXTENT (coordinates or extents beyond 1e+-150, or
 * edges and coordinates that differ from the mean edge by a factor of more than 1e75),
 * GD_DEGENERATE_FACE (a repeated vertex, an edge of length zero, or a height of less than 1e-7 of
 * the longest edge, because distances would be unreliable), GD_DUPLICATE_FACE,
 * GD_NON_MANIFOLD_EDGE, GD_NON_MANIFOLD_VERTEX, GD_NON_ORIENTABLE, GD_NOT_TRIANGLES,
 * GD_NOT_TRIANGULABLE, GD_UNSUPPORTED (a polygon of more than 4096 corners), GD_TOO_LARGE (more
 * than 2^30 triangles), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: expected O(n)
 * time and about 400 bytes a face while building. Thread-safe. */
GD_MUST_USE enum gd_status gd_mesh_build(const struct gd_polygons *polygons,
                                         const struct gd_mesh_options *options,
                                         const struct gd_control *control, struct gd_mesh **out,
                                         struct gd_detail *detail);

/* Like gd_mesh_build, but uses the arrays of the polygons as memory for the mesh, so that the build
 * needs less. `positions` and `corners` must be allocated by malloc or by the engine; they are NULL
 * afterwards if the build has freed them or moved them into the mesh. The counts stay. After
 * GD_BUDGET, the polygons are unchanged. In any case the caller frees them by gd_polygons_free. */
GD_MUST_USE enum gd_status gd_mesh_build_consuming(struct gd_polygons *polygons,
                                                   const struct gd_mesh_options *options,
                                                   const struct gd_control *control,
                                                   struct gd_mesh **out, struct gd_detail *detail);

/* Returns an upper bound of the bytes that are needed to build a mesh of that size, including the
 * mesh. With weld and repair, the bound holds if repair appends at most one vertex for every four
 * faces. If repair needs more copies of vertices, it checks the budget for their bytes. */
size_t gd_mesh_build_cost(uint64_t faces, uint64_t vertices);

struct gd_mesh *gd_mesh_retain(const struct gd_mesh *mesh);
void gd_mesh_release(const struct gd_mesh *mesh); /* NULL is allowed */
size_t gd_mesh_memsize(const struct gd_mesh *mesh);

struct gd_mesh_summary {
    /* number of vertex indices: vertices of the input, including unreferenced ones, and copies that
       repair appended */
    uint32_t index_count;
    uint32_t vertices; /* number of vertices of the surface */
    uint32_t faces;    /* number of triangles */
    /* number of face indices: `faces`, plus the triangles that weld and repair removed */
    uint32_t face_index_count;
    uint32_t edges;
    uint32_t components;
    uint32_t boundaries;            /* number of boundary loops */
    uint32_t unreferenced_vertices; /* number of vertex indices that no face uses */
    uint32_t saddle_vertices;       /* number of interior vertices with a total angle above 2 pi */
    /* number of nearly degenerate faces, whose height is less than 1e-6 of the longest edge;
       distances are still reliable, but a repair is advisable */
    uint32_t degenerate_faces;
    /* number of faces that were flipped to make the orientation consistent */
    uint32_t flipped_faces;
    int64_t euler_characteristic;
    int64_t genus; /* sum over the components */
    double area;
    struct gd_vec3 min, max; /* bounding box of the referenced vertices */
    struct {
        double min, mean, max;
    } edge_length;
};

/* Returns the summary, borrowed from the mesh and valid as long as the mesh. */
const struct gd_mesh_summary *gd_mesh_summary(const struct gd_mesh *mesh);

/* A report of the changes that weld and repair made. Vertex indices are those of the input; faces
 * are numbered as in struct gd_face.
 *
 * If a vertex is cut, the part with the lowest-numbered face keeps the index of the vertex. The
 * other parts get copies of the vertex. The copies are appended after the input's vertices, in the
 * order of their faces, from the index index_count - copies on. The index of a merged vertex refers
 * to the vertex into which it was merged. Faces keep their indices. The index of a removed face
 * stays unused: gd_point_in_face returns GD_OUT_OF_RANGE for it. The two faces of a flipped edge
 * keep their indices but have new corners (gd_mesh_corners).
 *
 * No point of the surface moves by more than `largest_shift`. No path crosses an edge that was cut.
 * engine/doc/003 explains which faces stay joined. */
struct gd_mesh_repair {
    /* index of a vertex, and the vertex into which it was merged */
    struct gd_mended vertices_welded;
    /* index of a vertex, and the vertex into which it was merged, because their edge has length
       zero, or less than 1e-6 of the longest edge of a nearly degenerate face */
    struct gd_mended vertices_merged;
    /* removed face, and the face with the same vertices and a lower index, which stays */
    struct gd_mended duplicate_faces;
    /* removed face without area, or removed nearly degenerate face without neighbours; [1] is 0 */
    struct gd_mended degenerate_faces;
    /* a nearly degenerate face, and the neighbour across its longest edge */
    struct gd_mended edges_flipped;
    /* the vertices of an edge with more than two faces, the lower one first */
    struct gd_mended edges_split;
    struct gd_mended vertices_split; /* vertex, and its number of appended copies */
    /* first triangle of a polygon, and a vertex that the polygon repeats */
    struct gd_mended faces_cut;
    uint32_t copies;                /* number of appended vertices */
    struct gd_mended lines_skipped; /* copy of gd_mesh_options.lines_skipped */
    /* bound of the distance by which welds, merges and flips moved any point of the surface */
    double largest_shift;
};

/* Returns the report of weld and repair. It is all zero if they changed nothing. It is borrowed
 * from the mesh and valid as long as the mesh. */
const struct gd_mesh_repair *gd_mesh_repair(const struct gd_mesh *mesh);

/* If repair appended the vertex, returns the input vertex of which it is a copy. Otherwise returns
 * the vertex itself. vertex.index < index_count. */
struct gd_vertex gd_mesh_original(const struct gd_mesh *mesh, struct gd_vertex vertex);

struct gd_boundary {
    uint32_t vertices; /* equals the number of edges */
    double length;
};

/* Returns the size of boundary loop `loop` < summary.boundaries. Loops are ordered by their lowest
 * vertex indices. O(1). */
struct gd_boundary gd_mesh_boundary(const struct gd_mesh *mesh, uint32_t loop);

/* Returns the position of a vertex, equal to that in the input to the last bit. The vertex may be
 * unreferenced. vertex.index < index_count. */
struct gd_vec3 gd_mesh_position(const struct gd_mesh *mesh, struct gd_vertex vertex);

/* Returns true if the face exists: its index is below face_index_count, and weld and repair did not
 * remove it. */
bool gd_mesh_has_face(const struct gd_mesh *mesh, struct gd_face face);

/* Returns the three corners of a face, which must exist (gd_mesh_has_face). Corner 0 is that of the
 * input; corners 1 and 2 are exchanged if the face was flipped. Barycentric coordinates always
 * follow the input's order. */
void gd_mesh_corners(const struct gd_mesh *mesh, struct gd_face face, struct gd_vertex corners[3]);

/* Returns the index of the input polygon that contains the triangle. */
uint32_t gd_mesh_source_face(const struct gd_mesh *mesh, struct gd_face face);

/* Converts the mesh to polygons, which the caller owns. They have all index_count positions, and
 * the existing faces in the order of their indices, with corners as in gd_mesh_corners. Error:
 * GD_NO_MEMORY. O(n). */
GD_MUST_USE enum gd_status gd_mesh_polygons(const struct gd_mesh *mesh, struct gd_polygons *out);

GD_EXTERN_C_END

#endif
