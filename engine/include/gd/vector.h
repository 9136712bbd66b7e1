/* Vector: tangent vectors at points of the surface, and the exponential and logarithmic maps.
 *
 *     struct gd_log log;  // q (-) p, from the shortest path from p to q
 *     if (gd_vector_log(mesh, &path, &log, NULL) == GD_OK) {
 *         struct gd_exp_request request = {&p, log.segments, log.count, NULL};
 *         gd_vector_exp(mesh, &request, NULL, &trace, NULL);  // ends in q
 *         gd_log_free(&log);
 *     }
 *
 * Source: "Geodesic Hermite splines on triangular meshes", section 3. p (+) v is the end of the
 * straightest geodesic that starts at p in the direction of v and has the length of v. q (-) p is
 * the vector of the shortest path from p to q. Transport along a shortest path keeps the signed
 * angle between vector and path. A shortest path may bend at saddle and boundary vertices; it then
 * has one vector for each segment between bends.
 *
 * Angles are those of gd/direction.h: at an interior vertex the total angle counts as 2 pi. The
 * length of a vector is in the caller's unit. All functions are thread-safe. */
#ifndef GD_VECTOR_H
#define GD_VECTOR_H

#include "gd/field.h"
#include "gd/trace.h"

GD_EXTERN_C_BEGIN

struct gd_vector {
    struct gd_direction direction; /* any direction if the length is 0 */
    double length;
};

/* The vectors of q (-) p. Segment 0 begins at p. Each further segment begins at the vertex where
 * the previous one ends. */
struct gd_log {
    /* has the direction of segment 0 and the length of the whole path */
    struct gd_vector vector;
    struct gd_vector *segments;
    uint32_t count; /* number of segments; 0 if q equals p */
};

void gd_log_free(struct gd_log *log); /* NULL is allowed */

/* Computes the vectors of a shortest path (from gd/query.h or gd/field.h), from its first point to
 * its last. The path between two bends is unfolded, so that a direction is as accurate as the whole
 * segment, even if the segment crosses an edge close to its start. The caller frees `*out` by
 * gd_log_free. Errors: GD_NO_MEMORY, GD_INTERNAL (the unfolded length differs from the path's by
 * more than 1e-9, so the path is not a shortest path). O(points). */
GD_MUST_USE enum gd_status gd_vector_log(const struct gd_mesh *mesh, const struct gd_path *path,
                                         struct gd_log *out, struct gd_detail *detail);

struct gd_exp_request {
    const struct gd_point *start;
    const struct gd_vector *segments;
    uint32_t count;                         /* segments */
    const struct gd_trace_options *options; /* NULL means all zero */
};

/* Computes p (+) v for a vector of one or more segments, which are traced one after another. Only
 * the angle of each direction is used; it is measured at the point where the segment begins. If a
 * segment except the last one ends near a vertex (within 1e-9 of the segment's length), it ends at
 * the vertex. If a segment meets the boundary and at most 1e-9 of its length is left, it counts as
 * complete. The path joins all segments. If a segment ends early (`out->end`), the following ones
 * are not traced. If there are no segments, the result is the start. Options and errors are those
 * of gd_trace_follow. */
GD_MUST_USE enum gd_status gd_vector_exp(const struct gd_mesh *mesh,
                                         const struct gd_exp_request *request,
                                         const struct gd_control *control, struct gd_trace *out,
                                         struct gd_detail *detail);

/* Transports `count` vectors from the first point of a shortest path to its last point, and
 * overwrites them with the results. The signed angle between vector and path does not change, not
 * even at bends. At the boundary a transported vector may lead off the surface; its angle is then
 * outside the surface's range, and the vector lies in the plane of the nearest face. Errors: those
 * of gd_vector_log. O(points and vectors). */
GD_MUST_USE enum gd_status gd_vector_transport(const struct gd_mesh *mesh,
                                               const struct gd_path *path,
                                               struct gd_vector *vectors, uint32_t count,
                                               struct gd_detail *detail);

/* Returns the sum of factors[i] * vectors[i] at a point. The sum may lead off the surface, as in
 * gd_vector_transport. */
struct gd_vector gd_vector_combine(const struct gd_mesh *mesh, const struct gd_point *point,
                                   const struct gd_vector *vectors, const double *factors,
                                   uint32_t count);

/* Computes q (-) p for all vertices q, from the complete field of p (one seed, no offset). For each
 * vertex index, writes the angle at p of the shortest path to the vertex, and the distance. Both
 * arrays have index_count entries. If there is no path, they are NAN and INFINITY. For p itself,
 * they are NAN and 0. For an unreferenced vertex, both are NAN. If several shortest paths lead to a
 * vertex, the result belongs to one of them, which may differ from the path of gd_field_path. The
 * function follows a path only to the first face with a known direction, so the cost is about O(n
 * log n) in all. Errors: GD_INVALID_ARGUMENT (a partial field, several seeds, a segment or an
 * offset), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. */
GD_MUST_USE enum gd_status gd_vector_log_all(const struct gd_field *field,
                                             const struct gd_control *control, double *angles,
                                             double *lengths, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
