/* Mesh: an immutable triangulated 2-manifold, with or without boundary, of one or more components.
 *
 *     struct gd_mesh *mesh;
 *     if (gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail) == GD_OK) {
 *         printf("genus %lld\n", (long long)gd_mesh_summary(mesh)->genus);
 *         gd_mesh_release(mesh);
 *     }
 *
 * Contract of the engine's whole surface: coordinates and distances are in the caller's length
 * unit, angles in radians; faces run counter- clockwise seen from outside; indices are zero-based;
 * numbers are IEEE doubles. Vertices are named by their index in the input, faces by their position
 * after triangulation (a polygon's triangles stand together). "Exact" means: on the polyhedron
 * itself, up to rounding, with a relative error of distances of at most 1e-9 (1e-14 is usual).
 *
 * A mesh is immutable once built: any number of threads may read it. Counts of references are
 * atomic. */
#ifndef GD_MESH_H
#define GD_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"
#include "gd/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_mesh;

/* Named by input index, so that a vertex can't be passed as a face. */
struct gd_vertex {
    uint32_t index;
};
struct gd_face {
    uint32_t index;
};

/* All zero: polygons are triangulated, nothing is welded, and what is no surface is refused. */
struct gd_mesh_options {
    bool refuse_polygons; /* GD_NOT_TRIANGLES instead of triangulating */
    bool repair_split;    /* mends what is no surface, see struct gd_mesh_repair */
    /* vertices that lie close together become one, whether faces join them or not */
    bool weld;
    double weld_tolerance; /* length >= 0; 0: only vertices at the same position */
};

/* Builds a mesh from polygons (borrowed for the call). `options`, `control` and `detail` may be
 * NULL.
 *
 * Polygons of up to 4096 corners are triangulated by diagonals that are not already edges of the
 * mesh; orientation is made consistent in each component (the majority of its faces keeps theirs);
 * vertices that no face uses keep their index.
 *
 * Weld: going through the vertices of the faces in order of index, each one joins the
 * lowest-numbered vertex within the tolerance that has joined none itself, and takes its position;
 * so nothing moves by more than the tolerance, and a chain of near vertices does not collapse into
 * one. The index of a welded vertex goes on naming the vertex that it joined. Faces that fall
 * together are removed, see gd_mesh_repair.degenerate_faces. Where the weld brings too many faces
 * to an edge or a vertex the refusal says so, or the repair cuts.
 *
 * Repair: see struct gd_mesh_repair. A one-sided component is refused all the same.
 *
 * Errors, each with the first offending elements in `detail`: GD_INVALID_ARGUMENT (a weld tolerance
 * that is no length, or so small beside the coordinates that it can only mean 0), GD_EMPTY (also
 * when weld or repair leave nothing), GD_INDEX, GD_NON_FINITE, GD_EXTENT (coordinates or extents
 * beyond 1e+-150, or edges and coordinates that differ from the mean edge by more than 1e75),
 * GD_DEGENERATE_FACE (a repeated vertex, an edge of length zero, or three corners on one line: a
 * height of less than 1e-7 of the longest edge, across which distances could not be trusted),
 * GD_DUPLICATE_FACE, GD_NON_MANIFOLD_EDGE, GD_NON_MANIFOLD_VERTEX, GD_NON_ORIENTABLE,
 * GD_NOT_TRIANGLES, GD_NOT_TRIANGULABLE, GD_UNSUPPORTED (a polygon of more than 4096 corners),
 * GD_TOO_LARGE (more than 2^30 triangles), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * Cost: expected O(n) time and about 500 bytes a face while building. The caller owns one reference
 * of `*out`. */
GD_MUST_USE enum gd_status gd_mesh_build(const struct gd_polygons *polygons,
                                         const struct gd_mesh_options *options,
                                         const struct gd_control *control, struct gd_mesh **out,
                                         struct gd_detail *detail);

/* Upper bound of the bytes that building a mesh of so many faces and vertices takes, the mesh
 * itself included; also with weld and repair, as long as repair appends no more than one vertex for
 * every four faces. Beyond that repair asks the budget for more. */
size_t gd_mesh_build_cost(uint64_t faces, uint64_t vertices);

struct gd_mesh *gd_mesh_retain(const struct gd_mesh *mesh);
void gd_mesh_release(const struct gd_mesh *mesh); /* NULL is harmless */
size_t gd_mesh_memsize(const struct gd_mesh *mesh);

struct gd_mesh_summary {
    /* vertices of the input, the unreferenced ones included, and the copies that repair appended */
    uint32_t index_count;
    uint32_t vertices; /* of the surface */
    uint32_t faces;    /* triangles */
    /* triangles of the input: `faces`, and those that weld and repair removed */
    uint32_t face_index_count;
    uint32_t edges;
    uint32_t components;
    uint32_t boundaries;            /* boundary loops */
    uint32_t unreferenced_vertices; /* indices that name no vertex of the surface */
    uint32_t saddle_vertices;       /* interior, total angle > 2 pi */
    /* nearly: height less than 1e-6 of the longest edge; answered, but worth mending */
    uint32_t degenerate_faces;
    uint32_t flipped_faces; /* turned over to make the orientation consistent */
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

#define GD_MENDED_LISTED 8

/* What a repair did of one kind: how often, and the elements of the first ones. */
struct gd_mended {
    uint32_t count;
    uint32_t listed; /* at most GD_MENDED_LISTED */
    uint32_t elements[GD_MENDED_LISTED][2];
};

/* What weld and repair did. Indices are the input's; faces are numbered as in struct gd_face.
 *
 * Vertices: the first copy of a vertex that is cut keeps its index (the one with the
 * lowest-numbered face), further ones are appended after the input's, in order of face: input
 * index_count - copies and up. The index of a merged vertex names the vertex that it was merged
 * into. Faces: each keeps its index. The index of a removed one stays unused: gd_point_in_face
 * answers it with GD_OUT_OF_RANGE. The two faces of a flipped edge keep their two indices but have
 * new corners (gd_mesh_corners).
 *
 * The surface is the same set of points as before but for `largest_shift`; where it was cut, no
 * path crosses. engine/doc/003 tells which faces stay together and why. */
struct gd_mesh_repair {
    struct gd_mended vertices_welded; /* index, the vertex that it joined */
    /* the same, by an edge of length zero, or of less than 1e-6 of a flat face's longest one */
    struct gd_mended vertices_merged;
    /* face removed, the lower face with the same vertices, which stays */
    struct gd_mended duplicate_faces;
    /* face removed because nothing was left of it, or flat with no single neighbour: face, 0 */
    struct gd_mended degenerate_faces;
    struct gd_mended edges_flipped; /* a flat face, and the neighbour over its longest edge */
    /* an edge of more than two faces: its vertices, the lower one first */
    struct gd_mended edges_split;
    struct gd_mended vertices_split; /* vertex, how many copies were appended */
    uint32_t copies;                 /* in all */
    /* length by which a point of the surface may have moved: welds, merges, flips */
    double largest_shift;
};

/* All zero when neither was asked for or nothing was to be done. Borrowed from the mesh, valid as
 * long as it. */
const struct gd_mesh_repair *gd_mesh_repair(const struct gd_mesh *mesh);

/* The vertex of the input that an appended one is a copy of; any other vertex itself. vertex.index
 * < index_count. */
struct gd_vertex gd_mesh_original(const struct gd_mesh *mesh, struct gd_vertex vertex);

struct gd_boundary {
    uint32_t vertices; /* and as many edges */
    double length;
};

/* The loop-th boundary loop, loop < summary.boundaries, in order of the lowest vertex index on
 * each. */
struct gd_boundary gd_mesh_boundary(const struct gd_mesh *mesh, uint32_t loop);

/* Position of a vertex as it was in the input (to the last bit), also for unreferenced ones.
 * vertex.index < index_count. */
struct gd_vec3 gd_mesh_position(const struct gd_mesh *mesh, struct gd_vertex vertex);

/* Is it a face: below face_index_count and not removed by weld or repair? */
bool gd_mesh_has_face(const struct gd_mesh *mesh, struct gd_face face);

/* The three corners of a face (gd_mesh_has_face): corner 0 as in the input, 1 and 2 exchanged when
 * the face was turned over to make the orientation consistent. Barycentric coordinates are always
 * by the input's order. */
void gd_mesh_corners(const struct gd_mesh *mesh, struct gd_face face, struct gd_vertex corners[3]);

/* Index of the input polygon that the triangle came from. */
uint32_t gd_mesh_source_face(const struct gd_mesh *mesh, struct gd_face face);

/* The triangles as polygons of their own (owned by the caller): all index_count positions, faces as
 * gd_mesh_corners in order of index; indices without a face are left out. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_mesh_polygons(const struct gd_mesh *mesh, struct gd_polygons *out);

#ifdef __cplusplus
}
#endif

#endif
