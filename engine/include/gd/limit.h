/* Limit surface: its points, their place in the control mesh, and what the surface does there.
 *
 *     struct gd_limit_point place = {.face = 3, .u = 0.25, .v = 0.5};
 *     struct gd_limit_jet jet;
 *     if (gd_limit_evaluate(surface, &place, &jet, NULL) == GD_OK) printf("%g\n", jet.position.z);
 *
 * A place is a face of the control mesh, numbered as in the input, and (u,v) in it: Catmull-Clark
 * quads are [0,1]^2 with u from the first corner to the second and v from the first to the fourth.
 * A polygon of n != 4 corners is n such quads, one a `corner`: u from that corner to the middle of
 * the edge to the next one, v to the middle of the edge to the one before, (1,1) in the middle of
 * the face. Loop triangles are u, v >= 0, u + v <= 1 with u from the first corner to the second and
 * v from the first to the third. */
#ifndef GD_LIMIT_H
#define GD_LIMIT_H

#include "gd/subdivision.h"
#include "gd/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_limit_point {
    uint32_t face, corner; /* corner: 0 but in polygons of n != 4 corners */
    double u, v;
};

struct gd_limit_places {
    const struct gd_limit_point *items;
    size_t count;
};

struct gd_limit_jet {
    struct gd_vec3 position;
    struct gd_vec3 normal; /* of unit length, outwards; NAN where there is none */
    struct gd_vec3 du, dv;
    struct gd_vec3 duu, duv, dvv;
    /* principal, ascending; positive where the surface bends towards its normal (a sphere's are
       -1/r) */
    double curvatures[2];
    /* At an extraordinary vertex, at the end of a crease, and at a corner that is no single face's,
     * derivatives in u and v vanish or are infinite: there du and dv are of unit length along the
     * face's two edges, second derivatives are 0 and curvatures NAN, for they have no limit in
     * general. A corner inside of a smooth surface is the tip of a spike, which has no normal;
     * there du and dv both are along its axis, or NAN. */
    bool singular;
};

/* The limit surface at a place: exact up to rounding (some 1e-15 of the one-ring's size), from
 * local subdivision to a bicubic B-spline or quartic box spline patch; at extraordinary vertices
 * from the limit masks (Halstead, Kass, DeRose 1993; Biermann, Levin, Zorin 2000). On a crease it
 * is the face's own side that is told. At the end of a boundary with one face (edge only) the
 * normal is the limit of the normals. Where control points coincide so that derivatives span no
 * plane there is a position, and no normal. `detail` may be NULL. Errors: GD_OUT_OF_RANGE (face or
 * corner), GD_INVALID_ARGUMENT (u, v outside the face by more than 1e-9 or not finite),
 * GD_NO_MEMORY. O(1) in regular places, else a few microseconds a halving of the distance to the
 * extraordinary vertex; on top of it memory for the work is set up: use gd_limit_evaluate_many for
 * many. */
GD_MUST_USE enum gd_status gd_limit_evaluate(const struct gd_subdivision *surface,
                                             const struct gd_limit_point *place,
                                             struct gd_limit_jet *out, struct gd_detail *detail);

/* As gd_limit_evaluate for each of the places, to places->count elements of `out`; the detail says
 * which is at fault. `control` may be NULL. On failure `out` is unspecified. Also GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. Places in order of faces are fastest. */
GD_MUST_USE enum gd_status gd_limit_evaluate_many(const struct gd_subdivision *surface,
                                                  const struct gd_limit_places *places,
                                                  const struct gd_control *control,
                                                  struct gd_limit_jet *out,
                                                  struct gd_detail *detail);

struct gd_limit_foot {
    struct gd_limit_point place;
    struct gd_vec3 position;
    double distance;
};

/* The limit-surface point nearest to `xyz`: Newton's iteration in every face whose control points'
 * box comes near enough, from the local minima of an 8 x 8 grid on it. A minimum that a grid of
 * that width doesn't show can be missed; otherwise to some 1e-14 of the coordinates. Of several
 * nearest points any one. `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not
 * finite), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: a look at every face (5 ns)
 * and tens of microseconds for each near one. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_nearest(const struct gd_subdivision *surface,
                                            struct gd_vec3 xyz, const struct gd_control *control,
                                            struct gd_limit_foot *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
