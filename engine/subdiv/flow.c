/* Gragg's modified midpoint rule, extrapolated: Hairer, Norsett, Wanner, Solving ordinary
 * differential equations I, II.9. The right-hand side is smooth on the whole patch, so a method of
 * high order is efficient: a patch usually takes one or two steps. */
#include "subdiv/flow.h"

#include <math.h>

#include "base/tolerance.h"

bool gd__components(const struct gd__jet *jet, struct gd_vec3 vector, double out[2])
{
    /* uses cross products, because products of lengths lose more digits if the derivatives are
       nearly parallel */
    struct gd_vec3 normal = gd_vec3_cross(jet->s, jet->t);
    double square = gd_vec3_dot(normal, normal);
    if (!(square > 0)) return false;
    out[0] = gd_vec3_dot(gd_vec3_cross(vector, jet->t), normal) / square;
    out[1] = gd_vec3_dot(gd_vec3_cross(jet->s, vector), normal) / square;
    return true;
}

double gd__sine(const struct gd__jet *jet)
{
    return gd_vec3_length(gd_vec3_cross(jet->s, jet->t)) /
           (gd_vec3_length(jet->s) * gd_vec3_length(jet->t));
}

struct slope {
    double v[4];
    double sine;
};

static struct slope flow_slope_at(const struct gd__scheme *rules, const struct gd__patch *patch,
                                  const double y[4])
{
    struct gd__jet jet;
    double c[2];
    rules->evaluate(patch, y[0], y[1], &jet);
    struct gd_vec3 a = gd_vec3_scale(jet.ss, y[2] * y[2]);
    a = gd_vec3_along(a, 2 * y[2] * y[3], jet.st);
    a = gd_vec3_along(a, y[3] * y[3], jet.tt);
    if (!gd__components(&jet, a, c)) c[0] = c[1] = NAN;
    return (struct slope){{y[2], y[3], -c[0], -c[1]}, gd__sine(&jet)};
}

static void midpoint(const struct gd__scheme *rules, const struct gd__patch *patch,
                     const double from[4], const struct slope *first, double step, int parts,
                     double out[4])
{
    double h = step / parts, before[4], now[4];
    for (int i = 0; i < 4; i++) {
        before[i] = from[i];
        now[i] = from[i] + h * first->v[i];
    }
    for (int n = 1; n <= parts; n++) {
        struct slope slope = flow_slope_at(rules, patch, now);
        for (int i = 0; i < 4; i++) {
            double next = n < parts ? before[i] + 2 * h * slope.v[i]
                                    : (before[i] + now[i] + h * slope.v[i]) / 2;
            before[i] = now[i];
            now[i] = next;
        }
    }
    for (int i = 0; i < 4; i++) out[i] = now[i];
}

enum { COLUMNS = 8 };

/* Returns the largest difference of two states: of places relative to the patch, of velocities
 * relative to the speed. */
static double flow_difference(const double a[4], const double b[4])
{
    double speed = fmax(fabs(a[2]), fabs(a[3]));
    double places = fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1]));
    return fmax(places, fmax(fabs(a[2] - b[2]), fabs(a[3] - b[3])) / speed);
}

bool gd__flow_advance(const struct gd__scheme *rules, const struct gd__patch *patch,
                      const struct gd__flow *from, double step, struct gd__flow *out)
{
    double start[4] = {from->s, from->t, from->ds, from->dt}, row[COLUMNS][4];
    struct slope first = flow_slope_at(rules, patch, start);
    for (int k = 0; k < COLUMNS; k++) {
        double last[4];
        midpoint(rules, patch, start, &first, step, 2 * (k + 1), row[k]);
        for (int i = 0; i < 4; i++) last[i] = k ? row[0][i] : 0;
        /* Neville's scheme: row[j] becomes the extrapolation of columns j to k */
        for (int j = k - 1; j >= 0; j--) {
            double ratio = (double)(k + 1) / (j + 1), weight = 1 / (ratio * ratio - 1);
            for (int i = 0; i < 4; i++)
                row[j][i] = row[j + 1][i] + weight * (row[j + 1][i] - row[j][i]);
        }
        if (k > 1 && flow_difference(row[0], last) * first.sine <= GD_TOL_GEODESIC) {
            *out = (struct gd__flow){row[0][0], row[0][1], row[0][2], row[0][3]};
            return true;
        }
    }
    return false;
}
