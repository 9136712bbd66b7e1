/* Trace: a straightest geodesic, the line that continues straight from a point in a direction,
 * across edges and vertices.
 *
 *     struct gd_direction ahead;
 *     struct gd_trace trace;
 *     if (gd_direction_at_angle(mesh, &start, 0.5, &ahead, NULL) == GD_OK &&
 *         gd_trace_follow(mesh, &(struct gd_trace_request){&start, &ahead, 2.0}, NULL, &trace,
 *                         NULL) == GD_OK) {
 *         printf("%u points\n", trace.path.count);
 *         gd_trace_free(&trace);
 *     }
 *
 * Source: K. Polthier and M. Schmies, "Straightest geodesics on polyhedral surfaces" (the rule
 * `bisect`); the paper on limit surfaces of Catmull-Clark meshes (the rule `normal`). Across an
 * edge the line is straight in the plane of the two unfolded faces. At a vertex, "straight" depends
 * on the rule:
 *     bisect    leaves half of the total angle on each side
 *     normal    continues in the plane that contains the arriving line and the vertex' normal: for
 *               meshes that approximate a smooth surface
 * If a line passes a vertex at a distance within rounding errors, it goes through the vertex.
 * Otherwise rounding errors would determine on which side it passes. Let e be the length of the
 * crossed edge and r the distance from the start. The tolerance is 1e-12 min(e, r) + 4e-15 e.
 *
 * At the boundary a line stops or slides. A line that slides turns into the boundary edge with
 * which it makes the smaller angle. It follows the boundary as long as its angle with the next edge
 * is acute. It leaves the boundary where its straight continuation is on the surface. At a boundary
 * vertex, the straight continuation makes the angle pi with the direction back along the line. */
#ifndef GD_TRACE_H
#define GD_TRACE_H

#include "gd/direction.h"
#include "gd/path.h"

GD_EXTERN_C_BEGIN

enum gd_vertex_rule { GD_VERTEX_RULE_BISECT, GD_VERTEX_RULE_NORMAL };
enum gd_boundary_rule { GD_BOUNDARY_RULE_STOP, GD_BOUNDARY_RULE_SLIDE };

#define GD_TRACE_STEPS 1000000 /* default limit on steps */

/* If all members are zero, the rule is `bisect`, the line stops at the boundary, may cross itself,
 * and has the default limit on steps. */
struct gd_trace_options {
    enum gd_vertex_rule vertex_rule;
    /* For GD_VERTEX_RULE_NORMAL: a normal of any length for each vertex index, borrowed. NULL means
       the mean of the faces' normals, weighted by angle. */
    const struct gd_vec3 *normals;
    enum gd_boundary_rule boundary_rule;
    /* true if the line ends where it crosses or touches an earlier segment of itself */
    bool stop_at_self_intersection;
    uint64_t step_limit; /* largest number of points after the first; 0 means GD_TRACE_STEPS */
};

struct gd_trace_request {
    const struct gd_point *start;
    const struct gd_direction *ahead;       /* a direction at `start`; only its angle is used */
    double length;                          /* >= 0 */
    const struct gd_trace_options *options; /* NULL means all zero */
};

enum gd_trace_end {
    GD_TRACE_END_LENGTH,
    GD_TRACE_END_BOUNDARY,
    GD_TRACE_END_SELF_INTERSECTION,
    GD_TRACE_END_STEP_LIMIT
};

struct gd_trace {
    /* path.length is the requested length if `end` is GD_TRACE_END_LENGTH, otherwise less */
    struct gd_path path;
    /* The straight continuation at the end. If the line ended at the boundary, this direction leads
       off the surface. */
    struct gd_direction direction;
    enum gd_trace_end end;
};

/* Frees the path and zeroes the struct. NULL is allowed. */
void gd_trace_free(struct gd_trace *trace);

/* Traces the line of the request. `control` and `detail` may be NULL. Lengths are compensated sums:
 * even a long line has the requested length to the last bits. The caller frees `*out` by
 * gd_trace_free. Errors: GD_INVALID_ARGUMENT (a length that is negative or not finite, an angle
 * that is not finite), GD_NOT_ON_SURFACE (the direction leads over the boundary), GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: O(points), and with stop_at_self_intersection also
 * O(pairs of segments in one face); 32 bytes a point. Thread-safe. */
GD_MUST_USE enum gd_status gd_trace_follow(const struct gd_mesh *mesh,
                                           const struct gd_trace_request *request,
                                           const struct gd_control *control, struct gd_trace *out,
                                           struct gd_detail *detail);

/* Returns direction `i` < `count` of a fan of `count` directions at equal angles. At an interior
 * point, the fan goes all around the point, beginning at angle zero. At a boundary point, it goes
 * from one direction along the boundary to the other, and includes both. If `count` is 1, the fan
 * has only the first of these directions. O(1); O(faces) at a vertex. */
struct gd_direction gd_trace_fan(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t count, uint32_t i);

GD_EXTERN_C_END

#endif
