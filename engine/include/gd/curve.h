/* Curve: a polyline on the surface, open or closed, consecutive points within one face; and the
 * ways to say where it runs.
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

#ifdef __cplusplus
extern "C" {
#endif

struct gd_curve {
    struct gd_point *points; /* owned; no two consecutive ones are equal */
    uint32_t count;          /* at least 1 */
    /* the last point is joined to the first, which is not repeated; they lie within one face */
    bool closed;
};

void gd_curve_free(struct gd_curve *curve); /* frees the points and zeroes; NULL is harmless */

/* Sum of its segments' lengths, in the mesh's unit. Thread-safe. */
double gd_curve_length(const struct gd_mesh *mesh, const struct gd_curve *curve);

enum gd_curve_kind {
    GD_CURVE_POINTS,   /* consecutive `points` are joined by shortest paths */
    GD_CURVE_VERTICES, /* consecutive `vertices` share an edge, which joins them */
    GD_CURVE_BOUNDARY  /* a boundary loop, closed, the surface at its left */
};

/* Where a curve runs. The arrays are borrowed. */
struct gd_curve_request {
    enum gd_curve_kind kind;
    bool closed;    /* the last is joined to the first; not asked for with a boundary */
    uint32_t count; /* of the points or vertices, at least 1 */
    const struct gd_point *points;
    const struct gd_vertex *vertices;
    uint32_t boundary;                    /* as for gd_mesh_boundary */
    const struct gd_landmarks *landmarks; /* of this mesh: they narrow searches; NULL: none */
};

/* The curve of a request, owned by the caller. Points that repeat the one before them are left out,
 * and points within 4e-12 of an edge or a vertex, as barycentric coordinates go, are put there; a
 * closed curve of two points runs there and back. `control` and `detail` may be NULL. Errors:
 * GD_INVALID_ARGUMENT (none given, or points that no path joins), GD_OUT_OF_RANGE,
 * GD_UNREFERENCED_VERTEX, GD_NO_SUCH_EDGE, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, and
 * what gd_pair_solve says. Cost: of gd_pair_solve for each pair of points; else linear in the
 * curve. Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_resolve(const struct gd_mesh *mesh,
                                            const struct gd_curve_request *request,
                                            const struct gd_control *control, struct gd_curve *out,
                                            struct gd_detail *detail);

/* A curve as the seeds of a field (gd/field.h): each point, followed by the segment from it to the
 * next one, if there is one; so seed 2i is point i and seed 2i + 1 the segment behind it.
 * gd_curve_seed_count of them. */
uint32_t gd_curve_seed_count(const struct gd_curve *curve);
void gd_curve_seeds(const struct gd_curve *curve, double offset, struct gd_seed *out);

#ifdef __cplusplus
}
#endif

#endif
