#include "wedge/contest.h"

/* D(t) = challenger's distance - owner's distance. D is 2-Lipschitz, and D = 0 is equation (1):
 *     sqrt((t - x1)^2 + y1^2) + sigma1 = sqrt((t - x2)^2 + y2^2) + sigma2.
 * With k = sigma2 - sigma1, P = 2 (x2 - x1), Q = x1^2 + y1^2 - x2^2 - y2^2, squaring twice gives
 *     4 k^2 ((t - x1)^2 + y1^2) = (P t + Q + k^2)^2,   valid where (P t + Q) sign(k) >= k^2,
 * a branch of a hyperbola met by the edge: up to two points. */

#define BISECTIONS 60

static bool beats(double difference, double scale)
{
    return difference < -GD_TOL_BETTER * scale;
}

/* Half the difference of the squared distances to the two sources at t, both factors free of cancellation; and what rounding may make of it. */
static double square_difference_at(const struct gd__window *c, const struct gd__window *o, double t, double *scale)
{
    double far_c = fabs(t - c->x) + c->y, far_o = fabs(t - o->x) + o->y, far = far_c > far_o ? far_c : far_o;
    *scale = far * (far + c->sigma);
    return 0.5 * ((o->x - c->x) * ((t - c->x) + (t - o->x)) + (c->y - o->y) * (c->y + o->y));
}

/* Equal sigma: the bisector is a line, found without a square root, robust where D cancels. */
static struct gd__verdict contest_equal(const struct gd__window *c, const struct gd__window *o, double lo, double hi)
{
    double scale_lo, scale_hi;
    double e_lo = square_difference_at(c, o, lo, &scale_lo), e_hi = square_difference_at(c, o, hi, &scale_hi);
    bool first = beats(e_lo, scale_lo), last = beats(e_hi, scale_hi);
    struct gd__verdict verdict = {.challenger_first = first};
    if (first == last) return verdict;
    double t = lo + (hi - lo) * (e_lo / (e_lo - e_hi));
    verdict.switches = 1;
    verdict.at[0] = t > lo ? (t < hi ? t : hi) : lo;
    return verdict;
}

/* One guarded Newton step on D; false when t is no root of D. */
static bool polish(const struct gd__window *c, const struct gd__window *o, double k, double lo, double hi, double *t)
{
    double dc = *t - c->x, d_o = *t - o->x;
    double rc = sqrt(dc * dc + c->y * c->y), ro = sqrt(d_o * d_o + o->y * o->y);
    double residual = rc - ro - k;
    if (fabs(residual) > GD_TOL_ROOT_RESIDUAL * (rc + ro)) return false;
    double slope = dc / rc - d_o / ro;
    if (fabs(slope) <= GD_TOL_POLISH_SLOPE) return true;
    double polished = *t - residual / slope;
    if (polished > lo && polished < hi && fabs(polished - *t) < GD_TOL_POLISH_STEP * (hi - lo)) *t = polished;
    return true;
}

/* Roots of the squared equation, in no order, NAN where there is none; u = t - lo keeps the coefficients small near a close source. */
static void squared_roots(const struct gd__window *c, const struct gd__window *o, double lo, double root[2],
                          double form[2])
{
    double xc = c->x - lo, xo = o->x - lo, k = o->sigma - c->sigma, k2 = k * k;
    double p = 2 * (xo - xc), q = (xc - xo) * (xc + xo) + (c->y - o->y) * (c->y + o->y), s = q + k2;
    double a = 4 * k2 - p * p, b = 4 * k2 * xc + p * s,
           e = 4 * k2 * (xc * xc + c->y * c->y) - s * s; /* a u^2 - 2 b u + e */
    double discriminant = b * b - a * e;
    form[0] = p;
    form[1] = q;
    root[0] = root[1] = NAN;
    if (discriminant < -GD_TOL_DISCRIMINANT * b * b) return;
    double r = sqrt(discriminant > 0 ? discriminant : 0), z = b >= 0 ? b + r : b - r;
    if (a != 0) root[0] = z / a;
    if (z != 0) root[1] = e / z;
}

/* Roots of D in (lo, hi) for unequal sigma, increasing; returns how many. */
static int roots_of(const struct gd__window *c, const struct gd__window *o, double lo, double hi, double root[2])
{
    double k = o->sigma - c->sigma, candidate[2], form[2];
    squared_roots(c, o, lo, candidate, form);
    double slack = GD_TOL_BRANCH * (fabs(form[1]) + fabs(form[0]) * (hi - lo));
    int count = 0;
    for (int i = 0; i < 2; i++) {
        double u = candidate[i], t = lo + u;
        if (!(t > lo && t < hi) || (form[0] * u + form[1]) * copysign(1, k) < k * k - slack) continue;
        if (polish(c, o, k, lo, hi, &t)) root[count++] = t;
    }
    if (count < 2) return count;
    if (root[0] > root[1]) {
        double t = root[0];
        root[0] = root[1];
        root[1] = t;
    }
    return root[1] - root[0] < GD_TOL_ROOT_SEPARATION * (hi - lo) ? 1 : 2;
}

static double difference_at(const struct gd__window *c, const struct gd__window *o, double t, double *scale)
{
    double dc = gd__window_distance(c, t), d_o = gd__window_distance(o, t);
    *scale = dc + d_o;
    return dc - d_o;
}

static bool challenger_wins_at(const struct gd__window *c, const struct gd__window *o, double t)
{
    double scale, difference = difference_at(c, o, t, &scale);
    return beats(difference, scale);
}

/* Where the winner changes exactly once but the quadratic is too ill-conditioned to say where. */
static double bisect(const struct gd__window *c, const struct gd__window *o, double lo, double hi,
                     bool challenger_first)
{
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        if (challenger_wins_at(c, o, middle) == challenger_first)
            lo = middle;
        else
            hi = middle;
    }
    return 0.5 * (lo + hi);
}

/* The same winner at both ends: it wins all of it, or the other wins a piece in the middle. */
static struct gd__verdict settle_same_ends(const struct gd__window *c, const struct gd__window *o, double lo, double hi,
                                           struct gd__verdict verdict)
{
    if (roots_of(c, o, lo, hi, verdict.at) < 2) return verdict;
    double scale, difference = difference_at(c, o, 0.5 * (verdict.at[0] + verdict.at[1]), &scale);
    bool other = verdict.challenger_first ? beats(-difference, scale) : beats(difference, scale);
    if (other) verdict.switches = 2;
    return verdict;
}

static struct gd__verdict settle_different_ends(const struct gd__window *c, const struct gd__window *o, double lo,
                                                double hi, struct gd__verdict verdict)
{
    int count = roots_of(c, o, lo, hi, verdict.at);
    if (count == 0) verdict.at[0] = bisect(c, o, lo, hi, verdict.challenger_first);
    /* two roots and different ends: one is at an end, up to rounding; the middle tells which */
    if (count == 2 && challenger_wins_at(c, o, 0.5 * (verdict.at[0] + verdict.at[1])) == verdict.challenger_first)
        verdict.at[0] = verdict.at[1];
    verdict.switches = 1;
    return verdict;
}

struct gd__verdict gd__contest(const struct gd__window *challenger, const struct gd__window *owner, double lo,
                               double hi)
{
    if (challenger->sigma == owner->sigma) return contest_equal(challenger, owner, lo, hi);
    double scale_lo, scale_hi;
    double d_lo = difference_at(challenger, owner, lo, &scale_lo),
           d_hi = difference_at(challenger, owner, hi, &scale_hi);
    bool first = beats(d_lo, scale_lo), last = beats(d_hi, scale_hi);
    struct gd__verdict verdict = {.challenger_first = first};
    if (first != last) return settle_different_ends(challenger, owner, lo, hi, verdict);
    if ((first ? -(d_lo + d_hi) : d_lo + d_hi) >= 2 * (hi - lo)) return verdict; /* D is 2-Lipschitz */
    return settle_same_ends(challenger, owner, lo, hi, verdict);
}
