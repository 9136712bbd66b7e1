/* Limit path: geodesics of the limit surface itself, by their differential equation. */
#ifndef GD_LIMIT_PATH_H
#define GD_LIMIT_PATH_H

#include "gd/limit.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_limit_step {
    struct gd_limit_point place;
    struct gd_vec3 position;
    double length; /* from the start */
};

enum gd_limit_end {
    GD_LIMIT_END_LENGTH,
    GD_LIMIT_END_BOUNDARY, /* it met the boundary of the surface */
    /* it met a corner, a vertex at a crease or a place without a normal, where no way is
       straight */
    GD_LIMIT_END_SINGULAR,
    GD_LIMIT_END_STEPS /* GD_LIMIT_STEPS */
};

#define GD_LIMIT_STEPS 1000000

struct gd_limit_path {
    /* step_count >= 1; from the start to where it ended, close enough to be drawn: some for each
       patch */
    struct gd_limit_step *steps;
    uint32_t step_count;
    double length;            /* falls short unless it ended by length */
    struct gd_vec3 direction; /* in which it would go on at the end, of unit length */
    enum gd_limit_end end;
};

/* Frees the steps and zeroes the struct. NULL is harmless. */
void gd_limit_path_free(struct gd_limit_path *path);

struct gd_limit_trace_request {
    struct gd_limit_point start;
    struct gd_vec3 direction; /* is projected onto the tangent plane */
    double length;            /* >= 0 */
};

/* The geodesic from a place in a direction. It solves x'' normal to the surface with x = S(u,v),
 * that is (u'',v'') = -g^-1 (S_u.a, S_v.a), a = S_uu u'^2 + 2 S_uv u'v' + S_vv v'^2, patch by
 * patch: each is a polynomial, which goes on smoothly beyond its border, and is left exactly at the
 * border. Over creases it goes on as it would if they were flattened; through extraordinary
 * vertices along its tangent. A start at a vertex of which a face is told where the direction
 * doesn't lead looks for the face where it does, on its own side of creases; where there is none,
 * or no normal, it ends at once. By Gragg's method with Bulirsch and Stoer's extrapolation,
 * relative error per patch 1e-13 (towards a spike, where a patch is a sliver, as much more as it is
 * flat) and so some 1e-11 after a hundred patches; chaos of the geodesic flow (negative curvature)
 * multiplies it as it does the error of the start. `control` and `detail` may be NULL; the caller
 * frees `*out`. Errors: those of gd_limit_evaluate; GD_INVALID_ARGUMENT (length, direction not
 * finite, or nothing of it is tangent); GD_INTERNAL (no step is short enough: control points all
 * but coincide); GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Some 50 us a patch.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_trace(const struct gd_subdivision *surface,
                                          const struct gd_limit_trace_request *request,
                                          const struct gd_control *control,
                                          struct gd_limit_path *out, struct gd_detail *detail);

struct gd_limit_geodesic {
    struct gd_limit_path path; /* empty unless it converged */
    /* of path.length: what it misses the end by, and what the integration may be off by */
    double error_estimate;
    bool converged;
};

/* Relaxes a polyline of at least two places, such as the shortest path on a discretization, onto
 * the geodesic of the limit surface between its ends: shooting. From the polyline's first way and
 * its length, Newton's method changes direction and length until the geodesic ends where it should;
 * how the end moves with the direction (the Jacobi field) is measured by a second geodesic beside
 * it. Not converged, and no error: when the end lies at a conjugate point, when the geodesic would
 * have to leave the surface (a shortest path along a boundary or around a corner is none), or when
 * the length becomes another one by more than a tenth, for then it is a geodesic of another kind.
 * `control` and `detail` may be NULL; the caller frees out->path. Errors: those of gd_limit_trace
 * for the first place; of gd_limit_evaluate for the others; GD_INVALID_ARGUMENT (fewer than two
 * places, or all in one point). Some ten traces. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_relax(const struct gd_subdivision *surface,
                                          const struct gd_limit_places *polyline,
                                          const struct gd_control *control,
                                          struct gd_limit_geodesic *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
