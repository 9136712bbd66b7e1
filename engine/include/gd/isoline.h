/* Isoline: the points of a surface at one distance (the level) from the seeds of a field, as exact
 * curves.
 *
 *     struct gd_isoline isoline;
 *     if (gd_isoline_trace(field, 0.25, NULL, &isoline) == GD_OK) {
 *         for (uint32_t i = 0; i < isoline.line_count; i++)
 *             printf("%.17g\n", isoline.lines[i].length);
 *         gd_isoline_free(&isoline);
 *     }
 *
 * In a face the distance is the minimum of the distances from several unfolded sources. Therefore
 * an isoline is a chain of circular arcs, each around an unfolded point source, and of straight
 * pieces, each parallel to a segment source. Arcs and pieces meet on edges and on the bisectors of
 * their sources. A line is closed, or open with both ends on the boundary. Seen from outside,
 * points nearer to the seeds lie to the left of a line. Lines are exact curves, not samples: at an
 * arc's end, the relative difference between the distance and the level is at most 1e-9 (1e-14 is
 * usual). A line is omitted if its length is within the rounding error, for example at a local
 * maximum or at level zero. Midway between two parallel segments, the distance is constant along a
 * ridge. At this level, a line runs along the ridge in both directions. */
#ifndef GD_ISOLINE_H
#define GD_ISOLINE_H

#include <math.h>

#include "gd/field.h"

GD_EXTERN_C_BEGIN

/* An arc around (u, v), counter-clockwise from the angle `from` to `to`. An arc that is only as
 * long as a rounding error may run backwards. Angles and (u, v) are measured in the face's plane,
 * with the origin at corner 0 and the x axis towards corner 1 (gd_mesh_corners).
 *
 * If `radius` is 0, arc i is a straight segment from point i of its line to point i + 1. Then (u,
 * v) is point i, `from` is 0 and `to` is the length. */
struct gd_isoline_arc {
    struct gd_face face;
    double u, v, radius; /* the caller's unit */
    double from, to;     /* radians */
    /* (u, v) in space: the arc's source unfolded into the face's plane, usually outside the face */
    struct gd_vec3 centre;
};

/* Returns the length of an arc in the caller's unit. */
static inline double gd_isoline_arc_length(const struct gd_isoline_arc *arc)
{
    return (arc->radius > 0 ? arc->radius : 1) * fabs(arc->to - arc->from);
}

/* Arc i runs from point i to point i + 1; the last arc of a closed line ends at point 0. */
struct gd_isoline_line {
    bool closed;
    double length; /* sum over the arcs */
    uint32_t arc_count;
    const struct gd_isoline_arc *arcs;
    uint32_t point_count; /* arc_count for a closed line, arc_count + 1 for an open one */
    const struct gd_point *points;
};

/* Owns all arrays of its lines. */
struct gd_isoline {
    double level;
    uint32_t line_count;
    struct gd_isoline_line *lines; /* open lines first */
    struct gd_isoline_arc *arcs;
    struct gd_point *points;
    size_t bytes; /* total size of the arrays */
};

/* Traces the isoline of a level >= 0, in the caller's unit. `control` may be NULL. The caller frees
 * `*out` by gd_isoline_free. Errors: GD_INVALID_ARGUMENT (a level that is negative or not finite),
 * GD_BEYOND_REACH (the level exceeds the reach of a partial field), GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. Cost: one pass over edges and faces, and O(k^2) for each face near the
 * line, where k is the number of wedges of the face's edges. Thread-safe. */
GD_MUST_USE enum gd_status gd_isoline_trace(const struct gd_field *field, double level,
                                            const struct gd_control *control,
                                            struct gd_isoline *out);

/* An index of the range of distances in each part of the surface. Tracing with an index needs no
 * pass over all edges and faces. An index retains its field. It is immutable: any number of threads
 * may trace with it. Errors of gd_isoline_index_create: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
struct gd_isoline_index;
GD_MUST_USE enum gd_status gd_isoline_index_create(const struct gd_field *field,
                                                   const struct gd_control *control,
                                                   struct gd_isoline_index **out);
void gd_isoline_index_destroy(struct gd_isoline_index *index); /* NULL is allowed */
size_t gd_isoline_index_bytes(const struct gd_mesh *mesh);

/* Traces an isoline with the index of a field. The isoline and the errors are those of
 * gd_isoline_trace. */
GD_MUST_USE enum gd_status gd_isoline_trace_indexed(const struct gd_isoline_index *index,
                                                    double level, const struct gd_control *control,
                                                    struct gd_isoline *out);

/* Frees the arrays and zeroes the struct. NULL is allowed. */
void gd_isoline_free(struct gd_isoline *isoline);

/* Computes the unit vectors of the arc's frame: the point at angle a of a circular arc is centre +
 * radius (cos(a) x + sin(a) y). O(1). */
void gd_isoline_arc_axes(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc,
                         struct gd_vec3 *x, struct gd_vec3 *y);

/* Approximates a line by a polyline within `tolerance` > 0 (a length) of the arcs, with at most
 * 1024 segments for each arc. The polyline contains all points of the line; a closed polyline
 * repeats its first point at the end. out->length is the polyline's length. `control` may be NULL.
 * The caller frees `*out` by gd_path_free. Errors: GD_INVALID_ARGUMENT (the tolerance),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. O(points). Thread-safe. */
GD_MUST_USE enum gd_status gd_isoline_flatten(const struct gd_mesh *mesh,
                                              const struct gd_isoline_line *line, double tolerance,
                                              const struct gd_control *control,
                                              struct gd_path *out);

/* Returns the number of points of the polyline from gd_isoline_flatten. O(arcs). */
uint64_t gd_isoline_flat_points(const struct gd_isoline_line *line, double tolerance);

GD_EXTERN_C_END

#endif
