/* Curve: an open or closed polyline on the surface whose consecutive points lie in one face. A
 * request describes a curve by points, vertices or a boundary loop.
 *
 *     struct gd_curve_request request = {
 *         .kind = GD_CURVE_POINTS, .points = points, .count = 4, .closed = true};
 *     struct gd_curve curve;
 *     if (gd_curve_resolve(mesh, &request, NULL, &curve, &detail) == GD_OK) {
 *         printf("%u points, length %g\n", curve.count, gd_curve_length(mesh, &curve));
 *         gd_curve_free(&curve);
 *     } */
#ifndef GD_CURVE_H
#define GD_CURVE_H

#include "gd/control.h"
#include "gd/field.h"
#include "gd/landmarks.h"
#include "gd/point.h"

GD_EXTERN_C_BEGIN

struct gd_curve {
    struct gd_point *points; /* owned; consecutive points differ */
    uint32_t count;          /* at least 1 */
    /* true if the last point is joined to the first; the first point is not repeated, and the two
       points lie in one face */
    bool closed;
};

/* Frees the points and zeroes the struct. NULL is allowed. */
void gd_curve_free(struct gd_curve *curve);

/* Returns the sum of the lengths of the curve's segments, in the mesh's unit. O(points).
 * Thread-safe. */
double gd_curve_length(const struct gd_mesh *mesh, const struct gd_curve *curve);

enum gd_curve_kind {
    GD_CURVE_POINTS,   /* consecutive `points` are joined by shortest paths */
    GD_CURVE_VERTICES, /* consecutive `vertices` share an edge, which joins them */
    GD_CURVE_BOUNDARY  /* a boundary loop: closed, with the surface on its left */
};

/* Describes a curve. The arrays are borrowed. */
struct gd_curve_request {
    enum gd_curve_kind kind;
    bool closed;    /* true if the last point is joined to the first; ignored for a boundary */
    uint32_t count; /* number of points or vertices, at least 1 */
    const struct gd_point *points;
    const struct gd_vertex *vertices;
    uint32_t boundary; /* number of the boundary loop, as in gd_mesh_boundary */
    /* landmarks of the same mesh, which make searches faster; may be NULL */
    const struct gd_landmarks *landmarks;
};

/* Computes the curve of a request; the caller frees it by gd_curve_free. A point that is equal to
 * the previous point is omitted. A point within 4e-12 of an edge or a vertex, in barycentric
 * coordinates, is moved onto it. A closed curve of two points runs from the first to the second and
 * back. `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (no points, or points on
 * different components), GD_OUT_OF_RANGE, GD_UNREFERENCED_VERTEX, GD_NO_SUCH_EDGE, GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE, and those of gd_pair_solve. Cost: for GD_CURVE_POINTS, that
 * of gd_pair_solve for each pair of consecutive points; otherwise linear in the size of the curve.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_resolve(const struct gd_mesh *mesh,
                                            const struct gd_curve_request *request,
                                            const struct gd_control *control, struct gd_curve *out,
                                            struct gd_detail *detail);

/* Convert a curve to seeds of a field (gd/field.h): seed 2i is point i, and seed 2i + 1 is the
 * segment from point i to the next point. gd_curve_seed_count returns the number of seeds.
 * gd_curve_seeds writes that many seeds to the caller's array. O(points). Thread-safe. */
uint32_t gd_curve_seed_count(const struct gd_curve *curve);
void gd_curve_seeds(const struct gd_curve *curve, double offset, struct gd_seed *out);

/* Divides the points and curves of a set of seeds into parts. Writes the number of each seed's
 * part, from 0 on, to `out`, and returns the number of parts. A point is one part. A curve must
 * have the seeds from gd_curve_seeds. It is divided at its corners, the points where it turns by
 * more than `turn` radians. A corner belongs to the part that begins there. O(seeds).
 * Thread-safe. */
uint32_t gd_curve_parts(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                        double turn, uint32_t *out);

GD_EXTERN_C_END

#endif
