/* A surface with its tessellation, and shortest paths on the surface. */
#pragma once

#include "gd/geodesic_like.h"
#include "tests/unit/nurbs/surfaces.h"

static const double promise = 1e-10; /* permitted relative error of a length */

struct scene {
    struct gd_parametric *surface;
    struct gd_tessellation *tessellation;
};

static inline struct scene open_scene(struct gd_parametric *surface)
{
    struct scene scene = {.surface = surface};
    struct gd_detail detail = {0};
    check_ok(gd_tessellation_build(surface, NULL, NULL, &scene.tessellation, &detail), &detail);
    return scene;
}

static inline void close_scene(struct scene *scene)
{
    gd_tessellation_release(scene->tessellation);
    gd_parametric_release(scene->surface);
}

/* Solves and releases both end curves. */
static inline struct gd_geodesics solve(const struct scene *scene, struct gd_domain_curve *from,
                                        struct gd_domain_curve *to,
                                        const struct gd_geodesic_options *options)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    check_ok(
        gd_geodesic_solve(scene->tessellation,
                          &(struct gd_geodesic_request){.from = from, .to = to, .options = options},
                          NULL, &found, &detail),
        &detail);
    gd_domain_curve_release(from);
    gd_domain_curve_release(to);
    return found;
}

static inline struct gd_domain_curve *polyline_of(const struct gd_parametric *surface,
                                                  const double (*corners)[2], uint32_t count)
{
    struct gd_domain_curve *curve;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_polyline(surface, &(struct gd_domain_polyline){corners, count}, NULL,
                                      &curve, &detail),
             &detail);
    return curve;
}
