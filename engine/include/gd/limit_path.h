/* Limit path: geodesics of the limit surface itself, computed from their differential equation. */
#ifndef GD_LIMIT_PATH_H
#define GD_LIMIT_PATH_H

#include "gd/limit.h"

GD_EXTERN_C_BEGIN

struct gd_limit_step {
    struct gd_limit_point place;
    struct gd_vec3 position;
    double length; /* length of the path from the start */
};

enum gd_limit_end {
    GD_LIMIT_END_LENGTH,
    GD_LIMIT_END_BOUNDARY, /* the path met the boundary of the surface */
    /* the path met a corner, a vertex at a crease, or a point without a normal; "straight" is
       undefined there */
    GD_LIMIT_END_SINGULAR,
    GD_LIMIT_END_STEPS /* the path reached GD_LIMIT_STEPS steps */
};

#define GD_LIMIT_STEPS 1000000

struct gd_limit_path {
    /* steps from the start to the end, at least one; each patch has several, enough for drawing */
    struct gd_limit_step *steps;
    uint32_t step_count;
    /* the requested length if `end` is GD_LIMIT_END_LENGTH, otherwise less */
    double length;
    struct gd_vec3 direction; /* unit tangent at the end */
    enum gd_limit_end end;
};

/* Frees the steps and zeroes the struct. NULL is allowed. */
void gd_limit_path_free(struct gd_limit_path *path);

struct gd_limit_trace_request {
    struct gd_limit_point start;
    struct gd_vec3 direction; /* is projected onto the tangent plane */
    double length;            /* >= 0 */
};

/* Traces the geodesic from a place in a direction. On a geodesic x = S(u,v) the acceleration x'' is
 * normal to the surface: (u'',v'') = -g^-1 (S_u.a, S_v.a), where a = S_uu u'^2 + 2 S_uv u'v' + S_vv
 * v'^2, and g is the metric, the 2x2 matrix of the scalar products of S_u and S_v. The equation is
 * solved patch by patch. Each patch is a polynomial that continues smoothly beyond its border. The
 * path leaves a patch exactly at its border. Across a crease, the path continues as if the crease
 * were flattened. Through an extraordinary vertex, it continues along its tangent. If the start is
 * a vertex and the direction does not lead into the start's face, the path starts in the face into
 * which the direction leads, if the creases at the vertex do not separate the two faces. If there
 * is no such face, or if the start has no normal, the path ends at once. Method: Gragg's method
 * with Bulirsch and Stoer's extrapolation. The relative error is 1e-13 for each patch (more in
 * slivers near a spike), and about 1e-11 after a hundred patches. On a surface of negative
 * curvature, these errors and errors of the start grow along the path. `control` and `detail` may
 * be NULL; the caller frees `*out` by gd_limit_path_free. Errors: those of gd_limit_evaluate;
 * GD_INVALID_ARGUMENT (length or direction not finite, or a direction without tangential
 * component); GD_INTERNAL (control points nearly coincide, so that no step is short enough for the
 * error bound); GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: about 50 us for each
 * patch. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_trace(const struct gd_subdivision *surface,
                                          const struct gd_limit_trace_request *request,
                                          const struct gd_control *control,
                                          struct gd_limit_path *out, struct gd_detail *detail);

struct gd_limit_geodesic {
    struct gd_limit_path path; /* empty unless `converged` */
    /* error of path.length: the distance between the path's end and its target, plus the
       integration error */
    double error_estimate;
    bool converged;
};

/* Computes the geodesic of the limit surface between the ends of a polyline of at least two places,
 * such as the shortest path on a discretization. The method is shooting: it starts with the
 * polyline's first direction and its length, and Newton's method adjusts both until the geodesic
 * ends at the polyline's end. A second geodesic with a slightly different direction measures the
 * derivative of the end point (the Jacobi field). `converged` is false if the end is a conjugate
 * point, or if no geodesic inside the surface exists (a shortest path along a boundary or around a
 * corner). It is also false if the lengths of the geodesic and the polyline differ by more than a
 * tenth, because the geodesic then takes another route. This is not an error. `control` and
 * `detail` may be NULL; the caller frees out->path. Errors: those of gd_limit_trace for the first
 * place; those of gd_limit_evaluate for the others; GD_INVALID_ARGUMENT (fewer than two places, or
 * all places are the same point). Cost: about ten traces. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_relax(const struct gd_subdivision *surface,
                                          const struct gd_limit_places *polyline,
                                          const struct gd_control *control,
                                          struct gd_limit_geodesic *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
