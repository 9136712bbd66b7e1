/* Isoline: the points of a surface at one distance from the seeds of a field, as the exact curves
 * that they form.
 *
 *     struct gd_isoline isoline;
 *     if (gd_isoline_trace(field, 0.25, NULL, &isoline) == GD_OK) {
 *         for (uint32_t i = 0; i < isoline.line_count; i++)
 *             printf("%.17g\n", isoline.lines[i].length);
 *         gd_isoline_free(&isoline);
 *     }
 *
 * In a face the distance is the least of those from several unfolded sources, so that an isoline is
 * a chain of circular arcs, each about one of them, and of straight pieces, each parallel to a
 * segment; they meet on edges and on the bisectors of their sources. Lines are closed, or open with
 * both ends on the boundary. Seen from outside, what is nearer to the seeds than the level lies to
 * the left of a line. Nothing here is sampled: an arc's end has the level's distance to 1e-9
 * relative (1e-14 is usual). A line that is no longer than rounding is a point, not a line, and is
 * left out: where the level is that of a local maximum, or zero. A ridge midway between two
 * parallel segments has one height along a whole piece: a line at that level goes there and
 * back. */
#ifndef GD_ISOLINE_H
#define GD_ISOLINE_H

#include <math.h>

#include "gd/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Counter-clockwise about its centre from angle `from` to `to` (an arc within rounding may run
 * backwards). Angles and (u, v) are in the frame of the face's plane whose origin is the face's
 * corner 0 and whose x axis points to its corner 1 (gd_mesh_corners).
 *
 * Of radius 0: straight from point i of its line to point i + 1. Then (u, v) is point i, `from` is
 * 0 and `to` the length. */
struct gd_isoline_arc {
    struct gd_face face;
    double u, v, radius; /* the caller's unit */
    double from, to;     /* radians */
    /* (u, v) in space; mostly outside the face: it is where the arc's source lies, unfolded into
       the plane */
    struct gd_vec3 centre;
};

/* In the caller's unit. */
static inline double gd_isoline_arc_length(const struct gd_isoline_arc *arc)
{
    return (arc->radius > 0 ? arc->radius : 1) * fabs(arc->to - arc->from);
}

/* Arc i runs from point i to point i + 1, the last one of a closed line back to point 0. */
struct gd_isoline_line {
    bool closed;
    double length; /* of the arcs */
    uint32_t arc_count;
    const struct gd_isoline_arc *arcs;
    uint32_t point_count; /* arc_count, or one more when it is open */
    const struct gd_point *points;
};

/* Owns all arrays of its lines. */
struct gd_isoline {
    double level;
    uint32_t line_count;
    struct gd_isoline_line *lines; /* open ones first */
    struct gd_isoline_arc *arcs;
    struct gd_point *points;
    size_t bytes; /* of the arrays */
};

/* Traces the isoline of a level >= 0. `control` may be NULL. The caller frees `*out` by
 * gd_isoline_free.
 * Errors: GD_INVALID_ARGUMENT (a level that is negative or not finite), GD_BEYOND_REACH (a partial
 * field ends before the level), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: one pass
 * over edges and faces, and O(k^2) for each face that the line may cross, of k wedges around it.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_isoline_trace(const struct gd_field *field, double level,
                                            const struct gd_control *control,
                                            struct gd_isoline *out);

/* Where on the surface the isolines of each level can be: made once, it spares every level but the
 * first the pass over all edges and faces. Retains its field. Immutable: any number of threads may
 * trace by it. Errors of making: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
struct gd_isoline_index;
GD_MUST_USE enum gd_status gd_isoline_index_create(const struct gd_field *field,
                                                   const struct gd_control *control,
                                                   struct gd_isoline_index **out);
void gd_isoline_index_destroy(struct gd_isoline_index *index); /* NULL is harmless */
size_t gd_isoline_index_bytes(const struct gd_mesh *mesh);

/* gd_isoline_trace by the index of the field: the same isoline. */
GD_MUST_USE enum gd_status gd_isoline_trace_indexed(const struct gd_isoline_index *index,
                                                    double level, const struct gd_control *control,
                                                    struct gd_isoline *out);

/* frees the arrays and zeroes; NULL is harmless */
void gd_isoline_free(struct gd_isoline *isoline);

/* Unit vectors of the arc's frame: the point at angle a of a round one is centre + radius (cos(a) x
 * + sin(a) y). */
void gd_isoline_arc_axes(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc,
                         struct gd_vec3 *x, struct gd_vec3 *y);

/* A line as a polyline, nowhere farther than `tolerance` > 0 (a length) from its arcs, of at most
 * 1024 segments an arc; it keeps the line's points, has more of them on the arcs, and ends in its
 * first point when the line is closed. The length is that of the polyline. `control` may be NULL.
 * The caller frees `*out` by gd_path_free. Errors: GD_INVALID_ARGUMENT (the tolerance),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. O(points). */
GD_MUST_USE enum gd_status gd_isoline_flatten(const struct gd_mesh *mesh,
                                              const struct gd_isoline_line *line, double tolerance,
                                              const struct gd_control *control,
                                              struct gd_path *out);

/* How many points that polyline has. O(arcs). */
uint64_t gd_isoline_flat_points(const struct gd_isoline_line *line, double tolerance);

#ifdef __cplusplus
}
#endif

#endif
