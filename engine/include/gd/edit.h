/* Edit: makes a new mesh from a mesh. The edits are simplification, subdivision, smoothing, filling
 * of holes, and selection of components.
 *
 *     struct gd_simplify_options options = {.faces = 10000};
 *     struct gd_edited edited;
 *     if (gd_simplify(mesh, &options, NULL, &edited, &detail) == GD_OK) {
 *         gd_mesh_build(&edited.polygons, NULL, NULL, &small, &detail);
 *         gd_edited_free(&edited);
 *     }
 *
 * gd_mesh_build accepts the result without repair. Equal inputs give equal results, to the last
 * bit. Each vertex of the result has an origin: the corresponding point of the input. */
#ifndef GD_EDIT_H
#define GD_EDIT_H

#include "gd/mesh.h"
#include "gd/polygons.h"

GD_EXTERN_C_BEGIN

/* A point of the input mesh, in the input's numbering of faces. */
struct gd_origin {
    double barycentric[3];
    uint32_t face;
};

struct gd_edited {
    struct gd_polygons polygons; /* triangles; every position is a corner of a triangle */
    struct gd_origin *origins;   /* one origin for each position */
    /* largest distance between result and input, in the input's unit, measured by
       gd_edit_deviation; 0 if gd_edit_apply knows that all faces are faces of the input */
    double largest_distance;
    /* the mesh of `polygons`, if gd_edit_apply built it to measure the distance; otherwise NULL */
    struct gd_mesh *mesh;
    size_t bytes; /* total size of the arrays and of the mesh */
};

/* Frees the arrays, releases the mesh and zeroes the struct. NULL is allowed. */
void gd_edited_free(struct gd_edited *edited);

/* Computes the largest sampled distance between two surfaces: from the vertices of `mesh` to
 * `edited`, and from the midpoints of faces and edges of `edited` to `mesh`, in the mesh's unit.
 * Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE, and those of gd_mesh_build for `edited`. Cost:
 * expected O(n log n) time, and the memory of a mesh of `edited`. Thread-safe. */
GD_MUST_USE enum gd_status gd_edit_deviation(const struct gd_mesh *mesh,
                                             const struct gd_polygons *edited,
                                             const struct gd_control *control, double *out,
                                             struct gd_detail *detail);

struct gd_simplify_options {
    /* stops at this number of faces; if 0, stops when `max_distance` allows no further collapse */
    uint32_t faces;
    double max_distance; /* limit on largest_distance, in the input's unit; 0 means no limit */
    /* true if boundary edges do not change; false if a quadric penalises changes of the boundary */
    bool keep_boundary;
};

/* Simplifies a mesh by edge collapses, in order of their quadric error. The remaining vertices keep
 * their positions and their order. A collapse is rejected if it turns a face by more than 90
 * degrees, makes a face too flat, or changes the topology. Vertices with more than
 * GD_EDIT_VALENCE_MOST neighbours are not removed, and neither are their neighbours. Because of
 * these rules, the result may have more faces than requested.
 *
 * The caller frees `*out` by gd_edited_free. Errors: GD_INVALID_ARGUMENT (neither faces nor
 * max_distance, or an invalid length), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost:
 * expected O(n log n) time, and about 150 bytes a face. With max_distance, the time is several
 * times as long. Thread-safe. */
GD_MUST_USE enum gd_status gd_simplify(const struct gd_mesh *mesh,
                                       const struct gd_simplify_options *options,
                                       const struct gd_control *control, struct gd_edited *out,
                                       struct gd_detail *detail);

#define GD_EDIT_VALENCE_MOST 256

struct gd_components_options {
    uint32_t keep; /* number of components to keep; at least 1 */
    uint32_t skip; /* number of largest components to omit */
};

/* Sorts components by area, the largest first, and in a tie by their lowest face. Omits the first
 * `skip` components, and keeps the next `keep` ones, or all that are left if there are fewer. The
 * caller frees `*out` by gd_edited_free. Errors: GD_INVALID_ARGUMENT (also if no component is
 * left), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: linear. Thread-safe. */
GD_MUST_USE enum gd_status gd_components(const struct gd_mesh *mesh,
                                         const struct gd_components_options *options,
                                         const struct gd_control *control, struct gd_edited *out,
                                         struct gd_detail *detail);

#define GD_EDIT_FACES_MOST (1u << 30)

enum gd_subdivide_scheme { GD_SUBDIVIDE_MIDPOINT, GD_SUBDIVIDE_LOOP, GD_SUBDIVIDE_SQRT3 };

/* MIDPOINT divides each face into four coplanar faces. LOOP divides faces in the same way and moves
 * all vertices by Loop's weights. SQRT3 divides each face at its centroid and flips the old edges
 * (Kobbelt 2000); the boundary does not change. In the result, the vertices of the input come
 * first, then one vertex for each edge (MIDPOINT, LOOP) or face (SQRT3). */
struct gd_subdivide_options {
    enum gd_subdivide_scheme scheme;
    uint32_t levels; /* 1 to GD_SUBDIVIDE_LEVELS_MOST */
};

#define GD_SUBDIVIDE_LEVELS_MOST 6

enum gd_smooth_direction { GD_SMOOTH_TANGENTIAL, GD_SMOOTH_NORMAL, GD_SMOOTH_BOTH };

struct gd_smooth_options {
    uint32_t iterations; /* 1 to GD_SMOOTH_ITERATIONS_MOST */
    enum gd_smooth_direction direction;
    /* an edge is a feature if the normals of its faces differ by more than this angle, in
       radians */
    double feature_angle;
};

#define GD_SMOOTH_ITERATIONS_MOST 1000

/* Moves each vertex half of the way to the mean of its neighbours, `iterations` times. Moves in the
 * tangent plane make faces more regular. Moves along the normal remove noise. Vertices on the
 * boundary and on features do not move. The caller frees `*out` by gd_edited_free. Errors:
 * GD_INVALID_ARGUMENT, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: linear for each
 * iteration. Thread-safe. */
GD_MUST_USE enum gd_status gd_smooth_mesh(const struct gd_mesh *mesh,
                                          const struct gd_smooth_options *options,
                                          const struct gd_control *control, struct gd_edited *out,
                                          struct gd_detail *detail);

struct gd_fill_options {
    uint32_t max_edges; /* boundary loops with more edges stay open; 3 to GD_FILL_EDGES_MOST */
};

/* usual value of max_edges; filling a hole of this size takes one or two seconds */
#define GD_FILL_EDGES      1000
#define GD_FILL_EDGES_MOST 2000

/* Fills each boundary loop of at most `max_edges` edges with triangles of least total area. The new
 * triangles are divided until they are as small as the faces around them, and then smoothed. The
 * faces and vertices of the input do not change; new faces and vertices come after them. A loop
 * stays open if it could only be closed with degenerate triangles, if its triangles would cross
 * each other or those of another loop, or if it is the border of a single face. New triangles may
 * cross faces of the input. The caller frees `*out` by gd_edited_free. Errors: GD_INVALID_ARGUMENT;
 * GD_NOT_TRIANGULABLE, with the vertices of a loop, if no loop can be closed; GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. For a loop of n edges: O(n^3) time and 10 n^2 bytes.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_fill(const struct gd_mesh *mesh,
                                   const struct gd_fill_options *options,
                                   const struct gd_control *control, struct gd_edited *out,
                                   struct gd_detail *detail);

/* --- several edits ---------------------------------------------------------------------------- */

enum gd_edit_kind {
    GD_EDIT_SIMPLIFY,
    GD_EDIT_COMPONENTS,
    GD_EDIT_SUBDIVIDE,
    GD_EDIT_SMOOTH,
    GD_EDIT_FILL
};

struct gd_edit_step {
    enum gd_edit_kind kind;
    union {
        struct gd_simplify_options simplify;
        struct gd_components_options components;
        struct gd_subdivide_options subdivide;
        struct gd_smooth_options smooth;
        struct gd_fill_options fill;
    };
};

#define GD_EDIT_STEPS_MOST 16

/* A sequence of edits. The array is borrowed for the call. */
struct gd_edit_steps {
    const struct gd_edit_step *items;
    uint32_t count;
    uint32_t *failed; /* receives the index of the last step that was begun; may be NULL */
};

/* Applies the steps in order. The origins of the result are points of `mesh`: kept vertices keep
 * their origins, and the origin of a new vertex is the nearest point of `mesh`. `largest_distance`
 * is measured between the result and `mesh`; faces that components and fill have kept are not
 * measured. The caller frees `*out` by gd_edited_free. Errors:
 * those of the steps; GD_INVALID_ARGUMENT (no steps, or too many); those of gd_mesh_build if the
 * result of a step is not a valid mesh. Thread-safe. */
GD_MUST_USE enum gd_status gd_edit_apply(const struct gd_mesh *mesh,
                                         const struct gd_edit_steps *steps,
                                         const struct gd_control *control, struct gd_edited *out,
                                         struct gd_detail *detail);

/* The components of an edited mesh: item i is the result of gd_components with keep = 1 and skip =
 * i. */
struct gd_edited_parts {
    struct gd_edited *items; /* each item has the largest_distance of the whole edited mesh */
    uint32_t count;
    size_t bytes; /* total size of all items */
};

/* Frees the arrays and zeroes the struct. NULL is allowed. */
void gd_edited_parts_free(struct gd_edited_parts *parts);

/* Splits an edited mesh into its components. The caller frees `*out` by gd_edited_parts_free.
 * Errors: GD_TOO_LARGE (more than `most` components), GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE.
 * Cost: linear time, and twice the bytes of `edited`. Thread-safe. */
GD_MUST_USE enum gd_status gd_edited_split(const struct gd_edited *edited, uint32_t most,
                                           const struct gd_control *control,
                                           struct gd_edited_parts *out, struct gd_detail *detail);

/* Returns an upper bound of the bytes that are needed to edit a mesh of that many faces, including
 * the result. */
size_t gd_edit_cost(uint64_t faces);

GD_EXTERN_C_END

#endif
