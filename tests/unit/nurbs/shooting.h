/* Shooting method: integrates the geodesic equation on a parametric surface by the Runge-Kutta pair
 * of Dormand and Prince with step control. Newton's method adjusts direction and length until the
 * geodesic reaches a given point. This code shares nothing with the engine's solver and is
 * therefore an independent reference for lengths. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "gd/domain_curve.h"

/* permitted error of a step, relative to the domain */
static const double shooting_tolerance = 1e-15;

/* Evaluates the surface's jet. Parameters that rounding places slightly outside the domain are
 * clamped to its border. */
static inline void shooting_jet(const struct gd_parametric *surface, const double at[2],
                                struct gd_jet *jet)
{
    const struct gd_axis *axes[2] = {gd_parametric_axis_u(surface), gd_parametric_axis_v(surface)};
    double place[2];
    for (int k = 0; k < 2; k++)
        place[k] = axes[k]->closed ? at[k] : fmin(fmax(at[k], axes[k]->low), axes[k]->high);
    enum gd_status status = gd_parametric_evaluate(surface, place[0], place[1], jet);
    (void)status;
}

/* Right-hand side of the geodesic equation: y = (u, v, u', v'); (u'', v'') = -g^-1 (x_u . a, x_v .
 * a), a = x_uu u'^2 + 2 x_uv u' v' + x_vv v'^2 */
static inline void shooting_slope(const struct gd_parametric *surface, const double y[4],
                                  double out[4])
{
    struct gd_jet x;
    shooting_jet(surface, y, &x);
    struct gd_vec3 a = gd_vec3_scale(x.uu, y[2] * y[2]);
    a = gd_vec3_along(a, 2 * y[2] * y[3], x.uv);
    a = gd_vec3_along(a, y[3] * y[3], x.vv);
    double e = gd_vec3_dot(x.u, x.u), f = gd_vec3_dot(x.u, x.v), g = gd_vec3_dot(x.v, x.v);
    double p = gd_vec3_dot(x.u, a), q = gd_vec3_dot(x.v, a), det = e * g - f * f;
    out[0] = y[2], out[1] = y[3];
    out[2] = -(g * p - f * q) / det;
    out[3] = -(e * q - f * p) / det;
}

/* Makes one step of length h. Returns the largest error estimate of u, v, u' and v'. */
static inline double shooting_step(const struct gd_parametric *surface, const double y[4], double h,
                                   double out[4])
{
    static const double a[7][6] = {
        {0},
        {1. / 5},
        {3. / 40, 9. / 40},
        {44. / 45, -56. / 15, 32. / 9},
        {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
        {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
        {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
    static const double e[7] = {71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                -17253. / 339200, 22. / 525, -1. / 40};
    double k[7][4], error = 0;
    for (int s = 0; s < 7; s++) {
        double at[4];
        memcpy(at, y, sizeof at);
        for (int j = 0; j < s; j++)
            for (int c = 0; c < 4; c++) at[c] += h * a[s][j] * k[j][c];
        if (s == 6) memcpy(out, at, sizeof at);
        shooting_slope(surface, at, k[s]);
    }
    for (int c = 0; c < 4; c++) {
        double sum = 0;
        for (int s = 0; s < 7; s++) sum += h * e[s] * k[s][c];
        error = fmax(error, fabs(sum));
    }
    return error;
}

/* Computes the end of the geodesic of this length that leaves `from` with the unit tangent
 * cos(angle) e1 + sin(angle) e2, where e1 points along x_u. */
static inline void shoot(const struct gd_parametric *surface, const double from[2], double angle,
                         double length, double to[2], double velocity[2])
{
    struct gd_jet x;
    shooting_jet(surface, from, &x);
    double e = gd_vec3_dot(x.u, x.u), f = gd_vec3_dot(x.u, x.v), g = gd_vec3_dot(x.v, x.v),
           w = sqrt(e * g - f * f);
    double y[4] = {from[0], from[1], cos(angle) / sqrt(e) - sin(angle) * f / (w * sqrt(e)),
                   sin(angle) * sqrt(e) / w};
    double done = 0, h = length / 64; /* h: the next step */
    for (int i = 0; i < 200000 && done < length; i++) {
        double next[4] = {0}, step = fmin(h, length - done);
        double error = shooting_step(surface, y, step, next);
        double scale = error > 0 ? 0.9 * pow(shooting_tolerance / error, 0.2) : 4;
        if (error <= shooting_tolerance || step < 1e-14 * length) {
            memcpy(y, next, sizeof y);
            done += step;
        }
        h = step * fmin(fmax(scale, 0.2), 4);
    }
    to[0] = y[0], to[1] = y[1];
    velocity[0] = y[2], velocity[1] = y[3];
}

/* Finds angle and length of the geodesic to `target` by Newton's method. Returns false if it does
 * not converge. */
static inline bool shoot_at(const struct gd_parametric *surface, const double from[2],
                            const double target[2], double *angle, double *length)
{
    for (int i = 0; i < 12; i++) {
        double at[2], turned[2], longer[2], velocity[2], unused[2], d = 1e-6;
        shoot(surface, from, *angle, *length, at, velocity);
        double r[2] = {at[0] - target[0], at[1] - target[1]};
        struct gd_jet x;
        shooting_jet(surface, at, &x);
        struct gd_vec3 miss = gd_vec3_along(gd_vec3_scale(x.u, r[0]), r[1], x.v);
        if (gd_vec3_length(miss) <= 1e-8 * *length) {
            /* the error along the path is subtracted from the length; the error across the path
             * changes the length only in second order */
            struct gd_vec3 t = gd_vec3_along(gd_vec3_scale(x.u, velocity[0]), velocity[1], x.v);
            *length -= gd_vec3_dot(miss, t);
            return true;
        }
        shoot(surface, from, *angle + d, *length, turned, unused);
        shoot(surface, from, *angle, *length * (1 + d), longer, unused);
        double a = (turned[0] - at[0]) / d, b = (longer[0] - at[0]) / (d * *length);
        double c = (turned[1] - at[1]) / d, e = (longer[1] - at[1]) / (d * *length),
               det = a * e - b * c;
        *angle -= (e * r[0] - b * r[1]) / det;
        *length -= (a * r[1] - c * r[0]) / det;
    }
    return false;
}

/* Returns the angle at which a path starts, from its first two points in the domain. */
static inline double shooting_angle(const struct gd_parametric *surface, const double from[2],
                                    const double next[2])
{
    struct gd_jet x;
    shooting_jet(surface, from, &x);
    struct gd_vec3 t = gd_vec3_along(gd_vec3_scale(x.u, next[0] - from[0]), next[1] - from[1], x.v);
    double e = gd_vec3_dot(x.u, x.u), f = gd_vec3_dot(x.u, x.v);
    struct gd_vec3 e2 = gd_vec3_along(x.v, -f / e, x.u);
    return atan2(gd_vec3_dot(t, e2) / gd_vec3_length(e2), gd_vec3_dot(t, x.u) / sqrt(e));
}

/* --- between two curves ----------------------------------------------------------------------- */

/* A path between two curves: parameters of its ends, its length, and the side on which it leaves
 * the first curve (1: left, -1: right). */
struct shot {
    double s, t, length, side;
};

/* Computes a curve's point and first derivative. The derivative is a difference quotient. This is
 * accurate enough, because an angle error e changes the length only by e^2. */
static inline void shooting_curve(const struct gd_domain_curve *curve, double s, double at[2],
                                  double first[2])
{
    double low, high, before[2], after[2];
    gd_domain_curve_range(curve, &low, &high);
    double h = 1e-6 * (high - low);
    gd_domain_curve_at(curve, s, at);
    gd_domain_curve_at(curve, s - h, before);
    gd_domain_curve_at(curve, s + h, after);
    for (int k = 0; k < 2; k++) first[k] = (after[k] - before[k]) / (2 * h);
}

/* Returns 1 if `place` lies to the left of the curve, as seen from the tip of the surface's normal,
 * otherwise -1. `place` must be close to the curve's point at `s`. */
static inline double shooting_side(const struct gd_domain_curve *curve, double s,
                                   const double place[2])
{
    const struct gd_parametric *surface = gd_domain_curve_surface(curve);
    double at[2], along[2];
    shooting_curve(curve, s, at, along);
    double ahead[2] = {at[0] + along[0], at[1] + along[1]};
    double turn = shooting_angle(surface, at, place) - shooting_angle(surface, at, ahead);
    return sin(turn) > 0 ? 1 : -1;
}

/* Computes the three numbers that Newton's method reduces to zero. The geodesic that leaves `from`
 * at a right angle ends near `to`. The first two numbers are the differences in u and v between its
 * end and `to`, and the third is the cosine of its angle with `to`. Sets *over to the excess
 * length. */
static inline void shooting_miss(const struct gd_domain_curve *from,
                                 const struct gd_domain_curve *to, const double x[3], double side,
                                 double out[3], double *over)
{
    const struct gd_parametric *surface = gd_domain_curve_surface(from);
    double begin[2], along[2], end[2], velocity[2], goal[2], across[2];
    shooting_curve(from, x[0], begin, along);
    double ahead[2] = {begin[0] + along[0], begin[1] + along[1]};
    shoot(surface, begin, shooting_angle(surface, begin, ahead) + side * M_PI_2, x[1], end,
          velocity);
    shooting_curve(to, x[2], goal, across);
    struct gd_jet jet;
    shooting_jet(surface, end, &jet);
    struct gd_vec3 tangent = gd_vec3_along(gd_vec3_scale(jet.u, velocity[0]), velocity[1], jet.v);
    struct gd_vec3 edge = gd_vec3_along(gd_vec3_scale(jet.u, across[0]), across[1], jet.v);
    for (int k = 0; k < 2; k++) out[k] = end[k] - goal[k];
    out[2] = gd_vec3_dot(tangent, edge) / gd_vec3_length(edge);
    *over = gd_vec3_dot(gd_vec3_along(gd_vec3_scale(jet.u, out[0]), out[1], jet.v), tangent);
}

/* Solves the 3 x 3 system with columns c by Cramer's rule. */
static inline void shooting_solve(struct gd_vec3 c[3], struct gd_vec3 r, double out[3])
{
    double det = gd_vec3_dot(c[0], gd_vec3_cross(c[1], c[2]));
    out[0] = gd_vec3_dot(r, gd_vec3_cross(c[1], c[2])) / det;
    out[1] = gd_vec3_dot(c[0], gd_vec3_cross(r, c[2])) / det;
    out[2] = gd_vec3_dot(c[0], gd_vec3_cross(c[1], r)) / det;
}

/* Finds the geodesic that meets both curves at right angles, by Newton's method on both parameters
 * and the length. *shot holds the initial values. Returns false if it does not converge. */
static inline bool shoot_between(const struct gd_domain_curve *from,
                                 const struct gd_domain_curve *to, struct shot *shot)
{
    double x[3] = {shot->s, shot->length, shot->t}, f[3], g[3], step[3], over, unused;
    struct gd_vec3 columns[3];
    for (int i = 0; i < 20; i++) {
        shooting_miss(from, to, x, shot->side, f, &over);
        if (fabs(f[0]) + fabs(f[1]) + fabs(f[2]) <= 1e-8) {
            /* the error across the path has an effect of second order */
            *shot = (struct shot){x[0], x[2], x[1] - over, shot->side};
            return true;
        }
        for (int k = 0; k < 3; k++) {
            double y[3] = {x[0], x[1], x[2]}, h = 1e-6 * fmax(1, fabs(x[k]));
            y[k] += h;
            shooting_miss(from, to, y, shot->side, g, &unused);
            columns[k] = (struct gd_vec3){(g[0] - f[0]) / h, (g[1] - f[1]) / h, (g[2] - f[2]) / h};
        }
        shooting_solve(columns, (struct gd_vec3){f[0], f[1], f[2]}, step);
        for (int k = 0; k < 3; k++) x[k] -= step[k];
    }
    return false;
}
