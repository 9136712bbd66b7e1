/* Field: the exact geodesic distance from a set of sources, stored as wedges on every edge. A wedge
 * is an interval of an edge, with the source of the shortest paths that reach it.
 *
 *     struct gd_seed seed = {.point = p};
 *     struct gd_field *field;
 *     if (gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
 *                        &field, NULL) == GD_OK) {
 *         double distance;
 *         if (gd_field_distance(field, &q, &distance) == GD_OK) printf("%.17g\n", distance);
 *         gd_field_release(field);
 *     }
 *
 * Source: Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using edge-based data
 * structures" (Definition 1, rules C1 and C2, Properties 1-7), after Mitchell, Mount and
 * Papadimitriou 1987. A field is immutable once built and keeps its mesh alive; any number of
 * threads may read it. */
#ifndef GD_FIELD_H
#define GD_FIELD_H

#include "gd/path.h"

GD_EXTERN_C_BEGIN

struct gd_field;

/* A source: a point, or a straight open segment within one face. Each end of a segment must be a
 * seed of its own (gd_curve_seeds makes all seeds of a curve). */
struct gd_seed {
    struct gd_point point;
    double offset; /* >= 0, added to every distance from this seed */
    bool is_segment;
    struct gd_point end; /* the end of a segment that begins at `point`; ignored for a point */
};

struct gd_field_request {
    const struct gd_seed *seeds; /* borrowed; at least one */
    uint32_t seed_count;
    double radius; /* largest distance; 0 means no limit */
    /* the propagation stops as soon as this point's distance is final (Property 5 of the paper);
       may be NULL */
    const struct gd_point *target;
    /* gd_field_distances_only computes the distances of these points; NULL means of all vertices.
       Other functions ignore the points. */
    const struct gd_point *points;
    uint32_t point_count;
};

/* Builds the exact distance field of the seeds: propagates windows, and stores the final windows as
 * wedges. Segments have linear wedges, so that distances from segments are as exact as distances
 * from points (D. Bommes and L. Kobbelt, "Accurate computation of geodesic distance fields for
 * polygonal curves on triangle meshes", 2007). `control` and `detail` may be NULL. The result is
 * the same, to the last bit, in every call. The caller owns one reference of `*out`. Errors:
 * GD_INVALID_ARGUMENT (no seed, an offset that is negative or not finite, a segment whose ends are
 * one point or have no common face), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_RUNAWAY
 * (far more windows than any real mesh needs), GD_INTERNAL (the distances of two neighbours differ
 * by more than the length of their edge: rounding errors are too large on this surface). Cost:
 * about n^1.5 wedges on smooth curved meshes, 21 to 24 bytes each. Thread-safe. */
GD_MUST_USE enum gd_status gd_field_build(const struct gd_mesh *mesh,
                                          const struct gd_field_request *request,
                                          const struct gd_control *control, struct gd_field **out,
                                          struct gd_detail *detail);

/* Computes the distance at every vertex index, as gd_field_build and gd_field_vertex_distances do,
 * but keeps no field. `out` then has index_count entries. With `request->points`, computes the
 * distances of these points, as gd_field_distances does; `out` then has point_count entries. `out`
 * is untouched on failure. Errors: those of gd_field_build. Cost: 0.85 to 0.9 times the time of
 * gd_field_build. Memory for vertices: 8 bytes a vertex, plus records near the front of the
 * propagation; together 10 bytes a face for a million faces. Memory for other points: 106
 * bytes a face, the front's windows, and the wedges of the points' faces. Thread-safe. */
GD_MUST_USE enum gd_status gd_field_distances_only(const struct gd_mesh *mesh,
                                                   const struct gd_field_request *request,
                                                   const struct gd_control *control, double *out,
                                                   struct gd_detail *detail);

/* Creates a view of a field with the smaller reach `radius` > 0: points that are farther away are
 * beyond the reach of the view. The view shares the arrays of `field`, keeps `field` alive, and
 * reports the size of `field`. If `field` reaches no farther than `radius`, the result is `field`
 * itself. The caller owns one reference. Errors: GD_INVALID_ARGUMENT, GD_NO_MEMORY. O(1).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_field_within(const struct gd_field *field, double radius,
                                           struct gd_field **out);

struct gd_field *gd_field_retain(const struct gd_field *field);
void gd_field_release(const struct gd_field *field); /* NULL is allowed */
size_t gd_field_memsize(const struct gd_field *field);
const struct gd_mesh *gd_field_mesh(const struct gd_field *field);

/* Returns the reach, up to which distances are final, in the caller's unit. It is INFINITY for a
 * complete field. */
double gd_field_reach(const struct gd_field *field);

/* Returns true and sets `*out` if the field's only seed is a point without offset. */
bool gd_field_single_seed(const struct gd_field *field, struct gd_point *out);

struct gd_field_statistics {
    /* number of windows that were offered to edges, of windows that were propagated, and of wedges
       that are stored */
    uint64_t windows_created, windows_propagated, wedges;
    uint64_t sides_propagated, vertices_emitted;
    uint64_t build_ns;
};

const struct gd_field_statistics *gd_field_statistics(const struct gd_field *field);

/* Computes the distance at a point, or INFINITY if there is no path (the point is on another
 * component). Error: GD_BEYOND_REACH (the distance may exceed the reach of a partial field).
 * O(wedges of a face's edges). Thread-safe. */
GD_MUST_USE enum gd_status gd_field_distance(const struct gd_field *field,
                                             const struct gd_point *point, double *out);

/* Computes the distances at `count` points, and writes them to `out` in the order of `points`. They
 * equal the results of gd_field_distance to the last bit. INFINITY means no path. NaN means beyond
 * the reach of a partial field. `control` may be NULL. `out` is untouched on failure. For many
 * points or points without order, this is faster than single calls, because points are evaluated in
 * the mesh's order of faces and data is prefetched. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Holds up to 16 bytes a point while it runs. Thread-safe. */
GD_MUST_USE enum gd_status gd_field_distances(const struct gd_field *field,
                                              const struct gd_point *points, uint32_t count,
                                              const struct gd_control *control, double *out);

/* Writes the distance at every vertex index of the input to `out`, which has index_count entries.
 * INFINITY means no path, or beyond the reach. NaN means an unreferenced vertex. O(vertices). */
void gd_field_vertex_distances(const struct gd_field *field, double *out);

/* Returns the number of seeds of the request. O(1). */
uint32_t gd_field_seed_count(const struct gd_field *field);

/* Computes the distance at a point, as gd_field_distance, and the number of the nearest seed in the
 * request's order. If several seeds are equally near up to rounding, the selected seed is
 * deterministic, but gd_field_path may end at another of these seeds. If there is no path, the
 * results are INFINITY and UINT32_MAX. Errors: GD_BEYOND_REACH, GD_INTERNAL (the field's
 * predecessors lead to no seed). O(wedges of a face's edges + bends of the path). Thread-safe. */
GD_MUST_USE enum gd_status gd_field_nearest(const struct gd_field *field,
                                            const struct gd_point *point, double *distance,
                                            uint32_t *seed);

/* Computes the shortest path from `point` to its nearest seed; the caller frees it by gd_path_free.
 * Errors: GD_INTERNAL (the polyline's own length differs from the distance by more than 1e-9
 * relative), GD_NOT_ON_SURFACE (no path), GD_BEYOND_REACH, GD_NO_MEMORY. O(crossings).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_field_path(const struct gd_field *field, const struct gd_point *point,
                                         struct gd_path *out);

/* Computes the path as gd_field_path, and the number of the seed where the path ends. If several
 * seeds are equally near up to rounding, gd_field_nearest may return another seed. */
GD_MUST_USE enum gd_status gd_field_path_to_seed(const struct gd_field *field,
                                                 const struct gd_point *point, struct gd_path *out,
                                                 uint32_t *seed);

/* Computes the gradient of the distance at a point: the unit vector in the direction in which the
 * shortest path from the source arrives. The vector lies in the plane of the face that contains the
 * path's last segment. At a vertex or a point of an edge, it usually does not lie in the planes of
 * the other faces. Where several shortest paths arrive, the gradient is undefined; the result then
 * belongs to the path that gd_field_path returns. Errors: GD_INVALID_ARGUMENT (the point is a
 * seed), GD_NOT_ON_SURFACE (no path), GD_BEYOND_REACH. O(wedges of a face's edges). Thread-safe. */
GD_MUST_USE enum gd_status gd_field_gradient(const struct gd_field *field,
                                             const struct gd_point *point, struct gd_vec3 *out);

/* Computes the point that is farthest from the seeds, and its distance. Ignores components without
 * a seed. The farthest point is a vertex, a point of a boundary edge where two shortest paths are
 * equally long, or a point of a face where three shortest paths are equally long. The choice
 * between several such points is deterministic. `control` may be NULL. Errors: GD_BEYOND_REACH (the
 * surface may continue beyond the reach of a partial field), GD_NO_MEMORY, GD_CANCELLED,
 * GD_DEADLINE. Cost: one pass over the faces, and a search of the few faces whose distances may
 * exceed those of all vertices. Thread-safe. */
GD_MUST_USE enum gd_status gd_field_farthest(const struct gd_field *field,
                                             const struct gd_control *control,
                                             struct gd_point *point, double *distance);

/* A final wedge of an edge, Definition 1 of the paper: parameters b0 < b1, and the distances d0, d1
 * of the pseudo-source to these ends. All numbers are in the caller's unit; the parameters grow
 * along the edge from its lower-numbered vertex. sigma is the distance from the seeds to the
 * pseudo-source. tau is true if the pseudo-source lies to the left of the edge in that direction,
 * that is, on the side of the face that traverses the edge from the lower to the higher vertex. */
struct gd_wedge {
    double b0, b1, d0, d1, sigma;
    bool tau;
    /* true if the source is a segment; d0 and d1 are then distances from its line, and sigma is the
       seed's offset */
    bool linear;
    bool at_vertex;  /* true if the pseudo-source is a vertex; false if a seed */
    uint32_t source; /* input index of the vertex, or number of the seed */
};

/* Returns the wedges of the edge a-b, sorted by b0: `*count` wedges in `*out`, allocated by malloc
 * and owned by the caller. They cover the part of the edge within the field's reach. If paths run
 * along the edge itself, d0 or d1 is 0, and tau is arbitrary. For a seed segment on the edge, d0
 * and d1 are 0. Errors: GD_NO_SUCH_EDGE, GD_NO_MEMORY. O(wedges of the edge's faces).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_field_wedges(const struct gd_field *field, struct gd_vertex a,
                                           struct gd_vertex b, struct gd_wedge **out,
                                           uint32_t *count);

/* The wedges of all edges: those of edge i are wedges[first[i]] to wedges[first[i + 1] - 1]. An
 * all-zero struct is empty. */
struct gd_all_wedges {
    uint32_t edge_count;
    struct gd_vertex (*edges)[2]; /* the lower-numbered vertex first */
    uint32_t *first;              /* edge_count + 1 entries */
    struct gd_wedge *wedges;
};

/* Returns the wedges of gd_field_wedges for every edge, in the mesh's internal order of edges. The
 * caller frees the arrays by gd_all_wedges_free. `control` may be NULL. Errors, with *out empty:
 * GD_NO_MEMORY; GD_BUDGET (also more than 2^32 - 1 wedges); GD_CANCELLED; GD_DEADLINE. O(all
 * wedges). Thread-safe. */
GD_MUST_USE enum gd_status gd_field_all_wedges(const struct gd_field *field,
                                               const struct gd_control *control,
                                               struct gd_all_wedges *out);

/* Returns the size of the arrays in bytes. */
size_t gd_all_wedges_memsize(const struct gd_all_wedges *all);
void gd_all_wedges_free(struct gd_all_wedges *all);

/* --- images: a field as bytes, to be stored and mapped back ----------------------------------- */

/* gd_field_image_size returns the size of the field's binary image; gd_field_write_image writes
 * that many bytes to `bytes`. Any little-endian machine can open the image. O(bytes).
 * Thread-safe. */
size_t gd_field_image_size(const struct gd_field *field);
void gd_field_write_image(const struct gd_field *field, void *bytes);

struct gd_field_image {
    const void *bytes; /* 8-byte aligned */
    size_t size;
    void (*release)(void *user); /* NULL means that there is none */
    void *user;
};

/* Opens a field whose arrays stay in the image in memory. The bytes are borrowed until the field's
 * last reference is released; then `release(user)` is called. If opening fails, `release` is not
 * called. The mesh must be the mesh of the field, built by the same version from the same input.
 * Every index in the image is checked, so that a damaged image never causes an access outside its
 * arrays. Values are not checked; use a checksum for them. Errors: GD_UNRECOGNIZED (not an image,
 * or another version), GD_TRUNCATED, GD_INVALID_ARGUMENT (another mesh), GD_INDEX, GD_NO_MEMORY.
 * Cost: one pass over the image. Thread-safe. */
GD_MUST_USE enum gd_status gd_field_open_image(const struct gd_mesh *mesh,
                                               const struct gd_field_image *image,
                                               struct gd_field **out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
