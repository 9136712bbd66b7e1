/* Subdivision surface: a control mesh and a subdivision scheme, which define a limit surface.
 *
 *     struct gd_subdivision *surface;
 *     if (gd_subdivision_create(&control, GD_SCHEME_CATMULL_CLARK, NULL, &surface,
 *                               &detail) == GD_OK) {
 *         ...gd_limit_evaluate (gd/limit.h), gd_discretize (gd/discretization.h)...
 *         gd_subdivision_release(surface);
 *     }
 *
 * Coordinates are in the caller's length unit; faces are counter-clockwise seen from outside.
 * Rules: Catmull-Clark (1978) and Loop (1987) with the creases of DeRose, Kass, Truong (1998). An
 * edge of sharpness s >= 1 is subdivided as a crease, and its parts get sharpness s - 1. For 0 < s
 * < 1 the smooth and the crease rule are interpolated. Results equal those of OpenSubdiv's uniform
 * creasing. A surface is immutable: any number of threads may read it. */
#ifndef GD_SUBDIVISION_H
#define GD_SUBDIVISION_H

#include "gd/control.h"
#include "gd/control_mesh.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

enum gd_scheme {
    GD_SCHEME_CATMULL_CLARK, /* polygons of any number of corners */
    GD_SCHEME_LOOP           /* triangles */
};

struct gd_subdivision;

/* The number of vertices of one valence. */
struct gd_valence {
    uint32_t valence, count;
};

struct gd_subdivision_summary {
    uint32_t vertex_count, edge_count, face_count;
    uint32_t boundary_edges, boundary_loops;
    /* numbers of edges and vertices that are tagged with a sharpness above 0, without boundary
       edges */
    uint32_t crease_edges, corner_vertices;
    /* Interior vertices with a valence other than 4 (Loop: 6), by ascending valence. The valence of
       a vertex is its number of edges. */
    const struct gd_valence *extraordinary; /* borrowed, valid as long as the surface */
    uint32_t extraordinary_count;
};

/* Validates a control mesh and creates a surface. `control_mesh` is borrowed for the call;
 * `control` and `detail` may be NULL. The caller owns one reference of `*out`. Errors, with the
 * offending elements in `detail`: GD_EMPTY; GD_INDEX (in a face); GD_DEGENERATE_FACE (fewer than
 * three corners, or one vertex twice); GD_NON_FINITE, GD_EXTENT; GD_NOT_TRIANGLES (Loop);
 * GD_NON_MANIFOLD_EDGE, GD_NON_MANIFOLD_VERTEX; GD_NON_ORIENTABLE (two faces traverse an edge in
 * the same direction); GD_OUT_OF_RANGE (a tag's vertex), GD_NO_SUCH_EDGE (a crease that is not an
 * edge), GD_UNREFERENCED_VERTEX (a corner tag on a vertex without faces), GD_INVALID_ARGUMENT (a
 * sharpness below 0 or not a number); GD_UNSUPPORTED (GD_INTERPOLATE_NONE on a mesh with a
 * boundary); GD_TOO_LARGE (more than 2^26 corners); GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Cost: expected linear time; about 80 bytes a corner. Thread-safe. */
GD_MUST_USE enum gd_status gd_subdivision_create(const struct gd_control_mesh *control_mesh,
                                                 enum gd_scheme scheme,
                                                 const struct gd_control *control,
                                                 struct gd_subdivision **out,
                                                 struct gd_detail *detail);

/* Add or remove a reference. Thread-safe. */
struct gd_subdivision *gd_subdivision_retain(const struct gd_subdivision *surface);
void gd_subdivision_release(const struct gd_subdivision *surface); /* NULL is allowed */

/* Returns the size of the surface in bytes. */
size_t gd_subdivision_memsize(const struct gd_subdivision *surface);

enum gd_scheme gd_subdivision_scheme(const struct gd_subdivision *surface);

/* Returns a summary of the control mesh. O(1). */
struct gd_subdivision_summary gd_subdivision_summary(const struct gd_subdivision *surface);

/* Returns the control points, summary.vertex_count of them, borrowed and valid as long as the
 * surface. O(1). */
const struct gd_vec3 *gd_subdivision_control_points(const struct gd_subdivision *surface);

/* Writes the ends of each edge of the control mesh to `out`, which has summary.edge_count entries,
 * in the order in which the faces first name the edges. O(corners). */
void gd_subdivision_control_edges(const struct gd_subdivision *surface, uint32_t (*out)[2]);

GD_EXTERN_C_END

#endif
