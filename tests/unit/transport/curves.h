/* Helpers of the tests of operations on curves. */
#pragma once

#include "tests/unit/transport/lines.h"

#include "gd/curve.h"

static inline struct gd_curve curve_through(const struct gd_mesh *mesh,
                                            const struct gd_point *points, uint32_t count,
                                            bool closed)
{
    struct gd_curve curve;
    struct gd_detail detail = {0};
    const struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .points = points, .count = count, .closed = closed};
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, &detail), &detail);
    return curve;
}

/* Checks that the middle of each segment between consecutive points lies on the surface. */
static inline void check_curve(const struct gd_mesh *mesh, const struct gd_curve *curve,
                               double size)
{
    for (uint32_t i = 1; i < curve->count + curve->closed; i++) {
        struct gd_vec3 a = gd_point_position(mesh, &curve->points[i - 1]),
                       b = gd_point_position(mesh, &curve->points[i % curve->count]);
        struct gd_vec3 middle = gd_vec3_scale(gd_vec3_add(a, b), 0.5);
        struct gd_point foot;
        check_ok(gd_locate_nearest(mesh, middle, -1, &foot, NULL), NULL);
        assert_true(gd_locate_distance(mesh, middle, &foot) <= 1e-12 * size);
    }
}
