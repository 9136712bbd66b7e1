/* Vector: a tangent vector at a point of the surface, and what points and vectors do with each
 * other there.
 *
 *     struct gd_log log;     q (-) p, from the shortest path from p to q
 *     if (gd_vector_log(mesh, &path, &log, NULL) == GD_OK) {
 *         struct gd_exp_request request = {&p, log.segments, log.count, NULL};
 *         gd_vector_exp(mesh, &request, NULL, &trace, NULL);   ends in q
 *         gd_log_free(&log);
 *     }
 *
 * Source: "Geodesic Hermite splines on triangular meshes", section 3: p (+) v is the end of the
 * straightest geodesic from p in the direction of v, as long as v; q (-) p is the vector of the
 * shortest path from p to q; a vector is translated along the shortest path so that it keeps its
 * signed angle with it. A shortest path that bends at saddle or boundary vertices is more than one
 * vector: all of them are kept.
 *
 * Angles are those of gd/direction.h: at an interior vertex all around counts as 2 pi. The length
 * of a vector is in the caller's unit. All functions are thread-safe. */
#ifndef GD_VECTOR_H
#define GD_VECTOR_H

#include "gd/field.h"
#include "gd/trace.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_vector {
    struct gd_direction direction; /* any where the length is 0 */
    double length;
};

/* q (-) p. Segment i begins where segment i - 1 ends: at a vertex; the first one at p. */
struct gd_log {
    struct gd_vector vector;    /* direction of the first segment, length of the whole path */
    struct gd_vector *segments; /* count of them; none when q is p */
    uint32_t count;
};

void gd_log_free(struct gd_log *log); /* NULL is harmless */

/* The vectors of a shortest path (from gd/query.h or gd/field.h), from its first point to its last.
 * What lies between two bends is laid flat, so that a direction is as exact as the path is long,
 * however close to the start it crosses the first edge. Errors: GD_NO_MEMORY, GD_INTERNAL (the
 * segments laid flat are not as long as the path, to 1e-9: it was no shortest one). O(points). */
GD_MUST_USE enum gd_status gd_vector_log(const struct gd_mesh *mesh, const struct gd_path *path,
                                         struct gd_log *out, struct gd_detail *detail);

struct gd_exp_request {
    const struct gd_point *start;
    const struct gd_vector *segments;
    uint32_t count;                         /* segments */
    const struct gd_trace_options *options; /* NULL: all zero */
};

/* p (+) v for a vector of one or more segments, one traced after the other; of each direction only
 * the angle is read, at the point where the segment begins. A segment that is followed by another
 * and ends within 1e-9 of its length of a vertex ends there; one that meets the boundary with no
 * more than that left has come to its end. The path is that of all; if one ends early
 * (`out->end`), the rest is left out. No segment: the point itself. Options and errors as in
 * gd_trace_follow. */
GD_MUST_USE enum gd_status gd_vector_exp(const struct gd_mesh *mesh,
                                         const struct gd_exp_request *request,
                                         const struct gd_control *control, struct gd_trace *out,
                                         struct gd_detail *detail);

/* Moves `count` vectors from the first point of a shortest path to its last one, in place.
 * The signed angle between vector and path is kept, through unfolded strips and at bends. At the
 * boundary a vector may come to lead off the surface: it has its angle then, and lies in the plane
 * of the nearest face. Errors: those of gd_vector_log. O(points and vectors). */
GD_MUST_USE enum gd_status gd_vector_transport(const struct gd_mesh *mesh,
                                               const struct gd_path *path,
                                               struct gd_vector *vectors, uint32_t count,
                                               struct gd_detail *detail);

/* The sum of factors[i] vectors[i] at a point. The same about what leads off the surface. */
struct gd_vector gd_vector_combine(const struct gd_mesh *mesh, const struct gd_point *point,
                                   const struct gd_vector *vectors, const double *factors,
                                   uint32_t count);

/* q (-) p for all vertices q, from the whole field of p (one seed, no offset): angle of the
 * direction at p in which the shortest path to the vertex leaves it, and the distance, both by
 * vertex index (index_count doubles each). NAN, INFINITY: no path. NAN, 0: the vertex is p. NAN,
 * NAN: it is not referenced. Where several shortest paths lead to a vertex it is one of them, not
 * always that of gd_field_path. The ways are not walked: from a vertex it is some faces to one
 * whose way is known (about O(n log n) in all). Errors: GD_INVALID_ARGUMENT (another field),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. */
GD_MUST_USE enum gd_status gd_vector_log_all(const struct gd_field *field,
                                             const struct gd_control *control, double *angles,
                                             double *lengths, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
