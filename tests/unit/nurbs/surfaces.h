/* Surfaces that the tests share: NURBS of known shapes (torus, sphere, cylinder, cone) and
 * free-form NURBS. The caller releases them. */
#pragma once

#include <math.h>
#include <stdlib.h>

#include "gd/domain_curve.h"
#include "gd/nurbs.h"
#include "tests/support/test.h"

/* The unit circle as a rational quadratic with nine control points. The control points at corners
 * of the square have the weight sqrt(1/2). */
static const double circle_x[9] = {1, 1, 0, -1, -1, -1, 0, 1, 1};
static const double circle_y[9] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
static const double circle_knots[12] = {0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1};
static const double half_knots[8] = {0, 0, 0, 0.5, 0.5, 1, 1, 1};

static inline double circle_weight(int i)
{
    return i % 2 ? M_SQRT1_2 : 1;
}

/* Returns the circle's parameter at an angle in [0, 2 pi]. Within a quarter, it is a rational
 * function of tan(angle / 2). */
static inline double circle_parameter(double angle)
{
    double quarter = fmin(floor(angle / M_PI_2), 3), t = tan(0.5 * (angle - quarter * M_PI_2));
    /* sin = sqrt2 x(1-x) + x^2, cos = (1-x)^2 + sqrt2 x(1-x); with y = x/(1-x): tan(angle) = (sqrt2
     * y + y^2)/(1 + sqrt2 y), y = t sqrt2/(1-t) */
    double y = M_SQRT2 * t / (1 - t);
    return (quarter + y / (1 + y)) / 4;
}

static inline struct gd_parametric *surface_of(const struct gd_nurbs_data *data)
{
    struct gd_parametric *surface;
    struct gd_detail detail = {0};
    check_ok(gd_nurbs_create(data, &surface, &detail), &detail);
    return surface;
}

/* Creates the torus of ../shared/data/nurbs_torus.json, scaled and moved. u runs around the axis, v
 * around the tube. */
static inline struct gd_parametric *nurbs_torus(double major, double minor, double scale,
                                                double shift)
{
    double points[81][3], weights[81];
    for (int i = 0; i < 9; i++) {
        for (int j = 0; j < 9; j++) {
            double radius = major + minor * circle_x[j], *p = points[9 * i + j];
            p[0] = scale * radius * circle_x[i] + shift;
            p[1] = scale * radius * circle_y[i] + shift;
            p[2] = scale * minor * circle_y[j] + shift;
            weights[9 * i + j] = circle_weight(i) * circle_weight(j);
        }
    }
    return surface_of(&(struct gd_nurbs_data){.degree_u = 2,
                                              .degree_v = 2,
                                              .count_u = 9,
                                              .count_v = 9,
                                              .knots_u = circle_knots,
                                              .knots_v = circle_knots,
                                              .knot_count_u = 12,
                                              .knot_count_v = 12,
                                              .points = (const double(*)[3])points,
                                              .weights = weights});
}

/* Creates the unit sphere of ../shared/data/nurbs_sphere.json. v runs from the south pole to the
 * north pole. */
static inline struct gd_parametric *nurbs_sphere(void)
{
    static const double radius[5] = {0, 1, 1, 1, 0}, height[5] = {-1, -1, 0, 1, 1};
    double points[45][3], weights[45];
    for (int i = 0; i < 9; i++) {
        for (int j = 0; j < 5; j++) {
            double *p = points[5 * i + j];
            p[0] = radius[j] * circle_x[i], p[1] = radius[j] * circle_y[i], p[2] = height[j];
            weights[5 * i + j] = circle_weight(i) * circle_weight(j);
        }
    }
    return surface_of(&(struct gd_nurbs_data){.degree_u = 2,
                                              .degree_v = 2,
                                              .count_u = 9,
                                              .count_v = 5,
                                              .knots_u = circle_knots,
                                              .knots_v = half_knots,
                                              .knot_count_u = 12,
                                              .knot_count_v = 8,
                                              .points = (const double(*)[3])points,
                                              .weights = weights});
}

/* Creates a ruled surface between two circles: a cylinder or a cone. v runs from 0 at the first
 * circle to 1 at the second. */
static inline struct gd_parametric *nurbs_ruled(double radius0, double height0, double radius1,
                                                double height1)
{
    double points[18][3], weights[18];
    static const double knots[4] = {0, 0, 1, 1};
    for (int i = 0; i < 18; i++) {
        double radius = i % 2 ? radius1 : radius0;
        points[i][0] = radius * circle_x[i / 2];
        points[i][1] = radius * circle_y[i / 2];
        points[i][2] = i % 2 ? height1 : height0;
        weights[i] = circle_weight(i / 2);
    }
    return surface_of(&(struct gd_nurbs_data){.degree_u = 2,
                                              .degree_v = 1,
                                              .count_u = 9,
                                              .count_v = 2,
                                              .knots_u = circle_knots,
                                              .knots_v = knots,
                                              .knot_count_u = 12,
                                              .knot_count_v = 4,
                                              .points = (const double(*)[3])points,
                                              .weights = weights});
}

/* Creates an open bicubic B-spline with count_u x count_v control points on a grid of unit cells,
 * with random bumps of this height. */
static inline struct gd_parametric *nurbs_bumps(int count_u, int count_v, double height,
                                                uint64_t seed)
{
    struct rng rng = {seed};
    double(*points)[3] = malloc((size_t)(count_u * count_v) * sizeof *points);
    double knots[2][64];
    int counts[2] = {count_u, count_v};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < counts[k] + 4; i++)
            knots[k][i] = i < 4 ? 0 : i >= counts[k] ? 1 : (double)(i - 3) / (counts[k] - 3);
    for (int i = 0; i < count_u * count_v; i++) {
        points[i][0] = i / count_v;
        points[i][1] = i % count_v;
        points[i][2] = rng_between(&rng, -height, height);
    }
    struct gd_parametric *surface =
        surface_of(&(struct gd_nurbs_data){.degree_u = 3,
                                           .degree_v = 3,
                                           .count_u = (uint32_t)count_u,
                                           .count_v = (uint32_t)count_v,
                                           .knots_u = knots[0],
                                           .knots_v = knots[1],
                                           .knot_count_u = (uint32_t)count_u + 4,
                                           .knot_count_v = (uint32_t)count_v + 4,
                                           .points = (const double(*)[3])points});
    free(points);
    return surface;
}

static inline struct gd_parametric *torus(double major, double minor)
{
    struct gd_parametric *surface;
    check_ok(gd_parametric_torus(major, minor, &surface, NULL), NULL);
    return surface;
}

static inline struct gd_parametric *plane(double half)
{
    struct gd_parametric *surface;
    double range[2] = {-half, half}, zero = 0;
    check_ok(gd_parametric_graph(&(struct gd_graph){0, 0, &zero, range, range}, &surface, NULL),
             NULL);
    return surface;
}

static inline struct gd_parametric *helicoid(void)
{
    struct gd_parametric *surface;
    check_ok(gd_parametric_helicoid(0.5, (double[]){0, 6}, (double[]){-1.5, 2}, &surface, NULL),
             NULL);
    return surface;
}

/* Creates the surface z = u v on the unit square. */
static inline struct gd_parametric *bilinear(void)
{
    struct gd_parametric *surface;
    check_ok(gd_parametric_graph(&(struct gd_graph){1, 1, (double[]){0, 0, 0, 1}, (double[]){0, 1},
                                                    (double[]){0, 1}},
                                 &surface, NULL),
             NULL);
    return surface;
}

/* Creates a vase: a cubic profile about the axis, open at both ends. */
static inline struct gd_parametric *vase(void)
{
    static const double knots[] = {0, 0, 0, 0, 1, 2, 3, 3, 3, 3};
    static const double points[6][2] = {{1, 0},     {1.8, 0.7}, {0.6, 1.6},
                                        {0.5, 2.3}, {1.3, 3},   {1.5, 3.4}};
    struct gd_profile profile = {3, 6, knots, points, NULL};
    struct gd_parametric *surface;
    check_ok(gd_parametric_revolution(&profile, &surface, NULL), NULL);
    return surface;
}

static inline struct gd_domain_curve *point_at(const struct gd_parametric *surface, double u,
                                               double v)
{
    struct gd_domain_curve *curve;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_point(surface, u, v, &curve, &detail), &detail);
    return curve;
}

static inline struct gd_domain_curve *iso_at(const struct gd_parametric *surface, enum gd_iso fixed,
                                             double at)
{
    struct gd_domain_curve *curve;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_iso(surface, fixed, at, &curve, &detail), &detail);
    return curve;
}

/* Creates a closed cubic B-spline around a point, nearly an ellipse with the half axes a and b. */
static inline struct gd_domain_curve *loop_at(const struct gd_parametric *surface, double u,
                                              double v, double a, double b)
{
    enum { POINTS = 12, DEGREE = 3, COUNT = POINTS + DEGREE };
    double points[COUNT][2], knots[COUNT + DEGREE + 1];
    for (int i = 0; i < COUNT; i++) {
        points[i][0] = u + a * cos(2 * M_PI * i / POINTS);
        points[i][1] = v + b * sin(2 * M_PI * i / POINTS);
    }
    for (int i = 0; i < COUNT + DEGREE + 1; i++) knots[i] = i - DEGREE;
    struct gd_domain_curve *curve;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_bspline(
                 surface,
                 &(struct gd_domain_bspline){DEGREE, knots, (const double(*)[2])points, COUNT},
                 NULL, &curve, &detail),
             &detail);
    return curve;
}
