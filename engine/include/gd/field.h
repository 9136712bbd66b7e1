/* Field: the exact geodesic distance from a set of source points, kept as the final-stage wedges of
 * every edge.
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

#ifdef __cplusplus
extern "C" {
#endif

struct gd_field;

/* A source: a point, or a straight segment within one face, without its ends, which are to be seeds
 * of their own (gd_curve_seeds makes all of a curve's). */
struct gd_seed {
    struct gd_point point;
    double offset; /* >= 0, added to every distance from this seed */
    bool is_segment;
    struct gd_point end; /* of a segment that begins at `point`; else ignored */
};

struct gd_field_request {
    const struct gd_seed *seeds; /* borrowed; at least one */
    uint32_t seed_count;
    double radius; /* stop there; 0: no limit */
    /* stop when this point's distance is final (the paper's Property 5); NULL: none */
    const struct gd_point *target;
};

/* Propagates wedges from the seeds and keeps the final ones: of segments linear ones, so that
 * distances to them are as exact as those to points (D. Bommes and L. Kobbelt, "Accurate
 * computation of geodesic distance fields for polygonal curves on triangle meshes", 2007).
 * `control` and `detail` may be NULL. An executor of width 2 or more in `control` halves a large
 * surface between two tasks (partition/partition.h): the same field every time, which differs from
 * that of one task by rounding. Errors: GD_INVALID_ARGUMENT (no seed, an offset that is negative or
 * not finite, a segment whose ends are one point or lie in no common face), GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_RUNAWAY (far more windows than any surface of sense
 * needs), GD_INTERNAL (the distances of two neighbours differ by more than their edge: rounding was
 * too coarse for this surface). Cost: about n^1.5 wedges on smooth curved meshes; 24 bytes a wedge.
 */
GD_MUST_USE enum gd_status gd_field_build(const struct gd_mesh *mesh,
                                          const struct gd_field_request *request,
                                          const struct gd_control *control, struct gd_field **out,
                                          struct gd_detail *detail);

/* The distance at every vertex index, as gd_field_vertex_distances gives it of such a field, for
 * one who wants no more: no wedges are made, nothing is kept. Errors: those of gd_field_build;
 * `out` is untouched then. Cost: a field's time but for some percent; memory: 8 bytes a vertex, and
 * what is known near the front, 10 bytes a face in all at a million faces. */
GD_MUST_USE enum gd_status gd_field_distances_only(const struct gd_mesh *mesh,
                                                   const struct gd_field_request *request,
                                                   const struct gd_control *control, double *out,
                                                   struct gd_detail *detail);

/* The field of the same seeds that reaches farther, to `radius` (0: no limit): what `partial`,
 * which stays as it is, has found is kept, and only what lies beyond is propagated. Its distances
 * are those of a field that was built for the radius at once, but for rounding. Its statistics
 * count the work of both. `control` and `detail` may be NULL. With an executor of width 2 or more
 * in `control`, where half of the vertices or more lie beyond the reach of `partial` and
 * gd_field_build would halve the surface, it is built from the seeds: that takes less time. So it
 * is where `partial` reaches no farther than 1e-3 of the longest edge, or the shortest edge is less
 * than 1e-6 of it. Errors: GD_INVALID_ARGUMENT (the radius is negative or no number, `partial`
 * reaches as far already, or it is a damaged image), and those of gd_field_build but for the
 * request. Cost: a copy of `partial`, and what lies beyond. */
GD_MUST_USE enum gd_status gd_field_resume(const struct gd_field *partial, double radius,
                                           const struct gd_control *control, struct gd_field **out,
                                           struct gd_detail *detail);

/* The field as one of that radius answers, which must be more than 0: what lies farther is beyond
 * its reach. It shares all of `field`, which lives as long, and tells the size of that; where
 * `field` reaches no farther it is `field` itself. The caller releases it. Errors:
 * GD_INVALID_ARGUMENT, GD_NO_MEMORY. O(1). */
GD_MUST_USE enum gd_status gd_field_within(const struct gd_field *field, double radius,
                                           struct gd_field **out);

struct gd_field *gd_field_retain(const struct gd_field *field);
void gd_field_release(const struct gd_field *field); /* NULL is harmless */
size_t gd_field_memsize(const struct gd_field *field);
const struct gd_mesh *gd_field_mesh(const struct gd_field *field);

/* Distances up to here are final and answered; INFINITY for a complete field. */
double gd_field_reach(const struct gd_field *field);

/* True when the field has one seed, a point without offset: `*out` is that point. */
bool gd_field_single_seed(const struct gd_field *field, struct gd_point *out);

struct gd_field_statistics {
    uint64_t windows_created, windows_propagated, wedges; /* offered to lists, propagated, kept */
    uint64_t sides_propagated, vertices_emitted;
    uint64_t build_ns;
};

const struct gd_field_statistics *gd_field_statistics(const struct gd_field *field);

/* Distance at a point. INFINITY: no path (another component). GD_BEYOND_REACH: a partial field does
 * not know. O(wedges of a face's edges). */
GD_MUST_USE enum gd_status gd_field_distance(const struct gd_field *field,
                                             const struct gd_point *point, double *out);

/* Distances at `count` points, in any order, to `out`: to the last bit those of gd_field_distance;
 * INFINITY where there is no path, NaN where a partial field does not know. `control` may be NULL;
 * `out` is untouched on failure. Faster than one by one where the points are many or in no order:
 * they are evaluated in the order in which the mesh keeps its faces, and what comes next is fetched
 * ahead. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Holds up to 16 bytes a point
 * while it runs. */
GD_MUST_USE enum gd_status gd_field_distances(const struct gd_field *field,
                                              const struct gd_point *points, uint32_t count,
                                              const struct gd_control *control, double *out);

/* Distance at every vertex index of the input (`out`: index_count doubles): INFINITY where there is
 * no path or beyond the reach, NaN for unreferenced vertices. */
void gd_field_vertex_distances(const struct gd_field *field, double *out);

/* How many seeds the request had. */
uint32_t gd_field_seed_count(const struct gd_field *field);

/* Distance at a point as gd_field_distance, and the number of the seed (in the request's order)
 * that it is the distance of: the one in which gd_field_path ends. Of seeds that are equally near
 * up to rounding it is one, always the same; gd_field_path may end in another of them. INFINITY and
 * UINT32_MAX: no path. GD_BEYOND_REACH: a partial field does not know. GD_INTERNAL: the ways that
 * the field keeps lead to no seed. O(wedges of a face's edges, and the path's bends). */
GD_MUST_USE enum gd_status gd_field_nearest(const struct gd_field *field,
                                            const struct gd_point *point, double *distance,
                                            uint32_t *seed);

/* The shortest path from `point` back to its nearest seed; free it by gd_path_free. The polyline's
 * own length is compared with the distance (1e-9 relative): GD_INTERNAL if they differ.
 * GD_NOT_ON_SURFACE: no path. GD_BEYOND_REACH, GD_NO_MEMORY. O(crossings). */
GD_MUST_USE enum gd_status gd_field_path(const struct gd_field *field, const struct gd_point *point,
                                         struct gd_path *out);

/* The same, and the number of the seed in which the path ends: where several are as near up to
 * rounding, perhaps not the one that gd_field_nearest tells. */
GD_MUST_USE enum gd_status gd_field_path_to_seed(const struct gd_field *field,
                                                 const struct gd_point *point, struct gd_path *out,
                                                 uint32_t *seed);

/* The gradient of the distance at a point: the unit vector in the plane of a face in which the
 * distance grows, that is the direction of the shortest path's last leg, away from the source. The
 * face is the one through which that leg comes: at a point of an edge or a vertex another face
 * around it may have it turned into its own plane. Where several shortest paths arrive there is no
 * gradient in the strict sense: the answer is the one of the path that gd_field_path gives, always
 * the same. Errors: GD_INVALID_ARGUMENT (the point is the seed itself: the distance grows in all
 * directions), GD_NOT_ON_SURFACE (no path), GD_BEYOND_REACH. O(wedges of a face's edges). */
GD_MUST_USE enum gd_status gd_field_gradient(const struct gd_field *field,
                                             const struct gd_point *point, struct gd_vec3 *out);

/* The point of the surface that is farthest from the seeds, and its distance: the true maximum over
 * all points that a path reaches (components without a seed are left out). It may be a vertex, a
 * point of a boundary edge between two ways that are as long, or a point of a face where three
 * meet. Of several that are as far it is one, always the same. `control` may be NULL. Errors:
 * GD_BEYOND_REACH (the surface goes on, or by less than an edge's length may go on, beyond the
 * reach of a partial field), GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. Cost: one pass over the
 * faces, and a closer look at those that may rise above all vertices: mostly few. */
GD_MUST_USE enum gd_status gd_field_farthest(const struct gd_field *field,
                                             const struct gd_control *control,
                                             struct gd_point *point, double *distance);

/* A final-stage wedge of an edge, Definition 1 of the paper: parameters b0 < b1 and the distances
 * d0, d1 of the pseudo-source to those ends, in the caller's unit along the edge from its
 * lower-numbered vertex; sigma: distance of the pseudo-source; tau: true when it lies to the left
 * of the edge in that direction (in the face that runs from the lower to the higher vertex). */
struct gd_wedge {
    double b0, b1, d0, d1, sigma;
    bool tau;
    /* of a segment: d0, d1 are distances at right angles to its line, sigma is the seed's offset */
    bool linear;
    bool at_vertex;  /* the pseudo-source is a vertex, else it is a seed */
    uint32_t source; /* input index of that vertex, or number of that seed */
};

/* The wedges of the edge a-b, sorted by b0: *count of them in `*out`, malloc'ed, owned by the
 * caller. GD_NO_SUCH_EDGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_field_wedges(const struct gd_field *field, struct gd_vertex a,
                                           struct gd_vertex b, struct gd_wedge **out,
                                           uint32_t *count);

/* --- images: a field as bytes, to be stored and mapped back ----------------------------------- */

/* Bytes of the field's image, and the image itself (gd_field_image_size bytes). Little-endian
 * machines of any kind read each other's. */
size_t gd_field_image_size(const struct gd_field *field);
void gd_field_write_image(const struct gd_field *field, void *bytes);

struct gd_field_image {
    const void *bytes; /* 8-byte aligned */
    size_t size;
    void (*release)(void *user); /* NULL: none */
    void *user;
};

/* A field over an image in memory, without a copy: the bytes are borrowed until `release(user)` is
 * called, which happens when the field's last reference goes, and not at all on failure. The mesh
 * must be the one the field was made on: built by the same version from the same input. Every index
 * in the image is checked, so that no image, however damaged, leads outside its arrays; that the
 * numbers are the ones written is for the caller's checksum to say. Errors: GD_UNRECOGNIZED (no
 * image, or of another version), GD_TRUNCATED, GD_INVALID_ARGUMENT (of another mesh), GD_INDEX,
 * GD_NO_MEMORY. Cost: one pass over the image. */
GD_MUST_USE enum gd_status gd_field_open_image(const struct gd_mesh *mesh,
                                               const struct gd_field_image *image,
                                               struct gd_field **out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
