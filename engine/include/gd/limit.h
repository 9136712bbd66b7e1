/* Limit surface: evaluates positions and derivatives of a subdivision surface.
 *
 *     struct gd_limit_point place = {.face = 3, .u = 0.25, .v = 0.5};
 *     struct gd_limit_jet jet;
 *     if (gd_limit_evaluate(surface, &place, &jet, NULL) == GD_OK) printf("%g\n", jet.position.z);
 *
 * A place is a point of the limit surface, given by a face of the control mesh, numbered as in the
 * input, and (u,v) in that face. In Catmull-Clark quads (u,v) is in [0,1]^2; u runs from the first
 * corner to the second, v from the first to the fourth. A polygon of n != 4 corners consists of n
 * quads, one for each `corner`. In such a quad u runs from its corner to the midpoint of the edge
 * to the next corner, and v runs from its corner to the midpoint of the edge to the previous
 * corner. (1,1) is the middle of the face. In Loop triangles u, v >= 0 and u + v <= 1; u runs from
 * the first corner to the second, v from the first to the third. */
#ifndef GD_LIMIT_H
#define GD_LIMIT_H

#include "gd/subdivision.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

struct gd_limit_point {
    uint32_t face, corner; /* `corner` is 0 except in polygons of n != 4 corners */
    double u, v;
};

struct gd_limit_places {
    const struct gd_limit_point *items;
    size_t count;
};

struct gd_limit_jet {
    struct gd_vec3 position;
    struct gd_vec3 normal; /* unit vector that points outwards; NAN means that there is no normal */
    struct gd_vec3 du, dv;
    struct gd_vec3 duu, duv, dvv;
    /* principal curvatures, ascending; positive where the surface bends towards its normal (for a
       sphere: -1/r) */
    double curvatures[2];
    /* True at an extraordinary vertex, at the end of a crease, and at a corner with several faces,
     * where derivatives in u and v vanish or are infinite. At such a place du and dv are unit
     * vectors along the face's two edges, second derivatives are 0, and curvatures are NAN, because
     * they have no limit in general. A vertex with a corner tag inside a smooth surface is the tip
     * of a spike and has no normal: du and dv both point along the spike's axis, or are NAN. */
    bool singular;
};

/* Evaluates the limit surface at a place, exactly up to rounding (about 1e-15 of the one-ring's
 * size). Method: the control mesh is subdivided locally until the place lies in a bicubic B-spline
 * or quartic box spline patch. At extraordinary vertices the limit masks are used (Halstead, Kass,
 * DeRose 1993; Biermann, Levin, Zorin 2000). On a crease, the values are those of the side on which
 * place->face lies. At a boundary vertex of only one face (GD_INTERPOLATE_EDGE_ONLY), the normal is
 * the limit of the normals nearby. If coincident control points make the derivatives parallel or
 * zero, the result has a position but no normal. `detail` may be NULL. Errors: GD_OUT_OF_RANGE
 * (face or corner), GD_INVALID_ARGUMENT (u, v outside the face by more than 1e-9 or not finite),
 * GD_NO_MEMORY. Cost: O(1) at regular places. At other places, it is a few microseconds for each
 * halving of the distance to the extraordinary vertex, and an allocation of working memory.
 * gd_limit_evaluate_many uses the same working memory for all places. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_evaluate(const struct gd_subdivision *surface,
                                             const struct gd_limit_point *place,
                                             struct gd_limit_jet *out, struct gd_detail *detail);

/* Evaluates the limit surface at each place; `out` has places->count elements. On an error, the
 * detail names the place, and `out` is unspecified. `control` may be NULL. Errors: those of
 * gd_limit_evaluate, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. This is fastest if places are ordered by
 * face. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_evaluate_many(const struct gd_subdivision *surface,
                                                  const struct gd_limit_places *places,
                                                  const struct gd_control *control,
                                                  struct gd_limit_jet *out,
                                                  struct gd_detail *detail);

struct gd_limit_closest {
    struct gd_limit_point place;
    struct gd_vec3 position;
    double distance;
};

/* Finds the point of the limit surface closest to `xyz`. In every face whose bounding box of
 * control points is near enough, applies Newton's method from the local minima of an 8 x 8 grid.
 * The search can miss a minimum narrower than that grid; otherwise the result is exact to about
 * 1e-14 of the coordinates. If several points are closest, the result is any of them. `control` and
 * `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not finite, or the square of the distance
 * overflows), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: 5 ns for every face, and
 * tens of microseconds for each face near `xyz`. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_nearest(const struct gd_subdivision *surface,
                                            struct gd_vec3 xyz, const struct gd_control *control,
                                            struct gd_limit_closest *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
