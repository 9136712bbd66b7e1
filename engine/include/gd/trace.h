/* Trace: a straightest geodesic, that is the line that goes straight on from a point in a
 * direction, over edges and vertices.
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
 * `bisect`); the paper on limit surfaces of Catmull-Clark meshes (the rule of normals). Across an
 * edge the two faces are laid flat. At a vertex there is more than one way to be straight:
 *     bisect    half of the total angle is left on each side
 *     normal    on in the plane of the line that comes in and the vertex' normal: for meshes that
 *               stand for a smooth surface
 * A line that passes a vertex within rounding goes through it, so that it doesn't matter to which
 * side of it rounding falls: within 1e-12 of the edge that it crosses or of the way from its start,
 * whichever is shorter, and 4e-15 of the edge.
 *
 * At the boundary a line stops, or slides: on along the boundary, to the side to which it leans, as
 * long as it makes an acute angle with the edge that comes next, and off it again where the
 * boundary falls back and straight on is surface. At a vertex of the boundary straight on is half a
 * turn from where the line came. */
#ifndef GD_TRACE_H
#define GD_TRACE_H

#include "gd/direction.h"
#include "gd/path.h"

#ifdef __cplusplus
extern "C" {
#endif

enum gd_vertex_rule { GD_VERTEX_RULE_BISECT, GD_VERTEX_RULE_NORMAL };
enum gd_boundary_rule { GD_BOUNDARY_RULE_STOP, GD_BOUNDARY_RULE_SLIDE };

#define GD_TRACE_STEPS 1000000 /* the step limit when none is given */

/* All zero: bisect, stop, through itself, and the usual limit. */
struct gd_trace_options {
    enum gd_vertex_rule vertex_rule;
    /* for the rule of normals: one a vertex index, of any length; NULL: the mesh's, the mean of the
     * faces' ones weighted by their angles. Borrowed */
    const struct gd_vec3 *normals;
    enum gd_boundary_rule boundary_rule;
    /* end where the line meets itself: crosses or touches where it has been */
    bool stop_at_self_intersection;
    uint64_t step_limit; /* most points of the path; 0: GD_TRACE_STEPS */
};

struct gd_trace_request {
    const struct gd_point *start;
    const struct gd_direction *ahead;       /* of this point; only its angle is read */
    double length;                          /* >= 0 */
    const struct gd_trace_options *options; /* NULL: all zero */
    uint32_t count;                         /* directions, of gd_trace_follow_many */
};

enum gd_trace_end {
    GD_TRACE_END_LENGTH,
    GD_TRACE_END_BOUNDARY,
    GD_TRACE_END_SELF_INTERSECTION,
    GD_TRACE_END_STEP_LIMIT
};

struct gd_trace {
    /* from the start to where it ended; path.length falls short unless it ended by length */
    struct gd_path path;
    /* in which it would go on at the end; where it met the boundary this leads off the surface */
    struct gd_direction direction;
    enum gd_trace_end end;
};

void gd_trace_free(struct gd_trace *trace); /* frees the path and zeroes; NULL is harmless */

/* The line of the request, whose count is not read. `control` and `detail` may be NULL. Lengths are
 * sums with compensation: a line is as long as was asked for to the last bits, however often it
 * winds. Errors: GD_INVALID_ARGUMENT (a length that is negative or not finite, an angle that is not
 * finite), GD_NOT_ON_SURFACE (the direction leads over the boundary), GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. Thread-safe. O(points), with self-intersections O(points and pairs of
 * them in one face); 32 bytes a point. */
GD_MUST_USE enum gd_status gd_trace_follow(const struct gd_mesh *mesh,
                                           const struct gd_trace_request *request,
                                           const struct gd_control *control, struct gd_trace *out,
                                           struct gd_detail *detail);

#define GD_TRACE_LANES 8 /* traces that gd_trace_follow_many follows at once */

/* The lines in request->count <= GD_TRACE_LANES directions to as many elements of `out`: each as
 * gd_trace_follow tells it, to the last bit. They go a face at a time in turn, so that on meshes
 * larger than the caches one's way to memory is spent on the others: four times as fast. All or
 * none: on failure `out` is untouched, and the detail that of the first to fail. Memory is asked
 * for all together. */
GD_MUST_USE enum gd_status gd_trace_follow_many(const struct gd_mesh *mesh,
                                                const struct gd_trace_request *request,
                                                const struct gd_control *control,
                                                struct gd_trace *out, struct gd_detail *detail);

/* Direction `i` of a fan of `count`: at equal angles all around from zero; at the boundary from one
 * side of it to the other, both included (one alone: along the first). i < count. O(1), at a vertex
 * O(its faces). */
struct gd_direction gd_trace_fan(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t count, uint32_t i);

#ifdef __cplusplus
}
#endif

#endif
