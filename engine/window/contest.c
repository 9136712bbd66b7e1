#include "window/contest.h"

/* D(t) = challenger's distance - owner's distance. D is 2-Lipschitz, and D = 0 is equation (1):
 *     sqrt((t - x1)^2 + y1^2) + sigma1 = sqrt((t - x2)^2 + y2^2) + sigma2.
 * With k = sigma2 - sigma1, P = 2 (x2 - x1), Q = x1^2 + y1^2 - x2^2 - y2^2, squaring twice gives
 *     4 k^2 ((t - x1)^2 + y1^2) = (P t + Q + k^2)^2,   valid where (P t + Q) sign(k) >= k^2.
 * The bisector is a branch of a hyperbola, which the edge meets in up to two points.
 *
 * The distance of a linear window is linear along the edge. The bisector of a linear window and a
 * point is a parabola. The equation is squared once, and the edge meets the parabola in up to two
 * points. The bisector of two linear windows is a line, which the edge meets in at most one
 * point. */

#define BISECTIONS 60

/* The window that gives the strictly shorter distance at a point. A tie at a point does not mean a
 * tie on the whole interval. If the point is far from two neighbouring sources, both distances are
 * equal up to rounding, although one source may be nearer to other points of the interval. */
enum winner { CHALLENGER = -1, TIE = 0, OWNER = 1 };

/* Branchless, because a branch would be mispredicted half of the time. */
static enum winner winner_of(double difference, double scale)
{
    double slack = GD_TOL_BETTER * scale;
    return (enum winner)((difference > slack) - (difference < -slack));
}

static struct gd__contest_result all_to(enum winner winner)
{
    return (struct gd__contest_result){.challenger_first = winner == CHALLENGER};
}

static double clamp(double t, double lo, double hi)
{
    return t < lo ? lo : t > hi ? hi : t;
}

/* Returns half the difference of the squared distances to both sources at t, and a bound on its
 * rounding error. The difference is computed as a sum of two products. The factors of these
 * products lose no digits by cancellation. */
static double square_difference_at(const struct gd__window *c, const struct gd__window *o, double t,
                                   double *scale)
{
    double far_c = fabs(t - c->x) + c->y, far_o = fabs(t - o->x) + o->y,
           far = far_c > far_o ? far_c : far_o;
    *scale = far * (far + c->sigma);
    return 0.5 * ((o->x - c->x) * ((t - c->x) + (t - o->x)) + (c->y - o->y) * (c->y + o->y));
}

/* The difference at a point of the edge. */
struct sample {
    double t, value;
    enum winner winner;
};

static struct sample sample_at(const struct gd__window *c, const struct gd__window *o, double t)
{
    double scale, value = square_difference_at(c, o, t, &scale);
    return (struct sample){t, value, winner_of(value, scale)};
}

static struct gd__contest_result split_linearly(struct sample a, struct sample b)
{
    struct gd__contest_result result = all_to(a.winner);
    result.switches = 1;
    result.at[0] = clamp(a.t + (b.t - a.t) * (a.value / (a.value - b.value)), a.t, b.t);
    return result;
}

/* Decides a contest with a tie at an end of the interval. Compares the windows at the points of the
 * interval that are nearest to the two sources. */
static struct gd__contest_result settle_linear_tie(const struct gd__window *c,
                                                   const struct gd__window *o, struct sample lo,
                                                   struct sample hi)
{
    double first = clamp(fmin(c->x, o->x), lo.t, hi.t),
           second = clamp(fmax(c->x, o->x), lo.t, hi.t);
    struct sample samples[4] = {lo, sample_at(c, o, first), sample_at(c, o, second), hi};
    struct sample last = {.winner = TIE};
    for (int i = 0; i < 4; i++) {
        if (samples[i].winner == TIE) continue;
        if (last.winner != TIE && samples[i].winner != last.winner)
            return split_linearly(last, samples[i]);
        last = samples[i];
    }
    return all_to(last.winner);
}

/* Contests (compares, see contest.h) two windows of equal sigma. Their bisector is a line. Its
 * crossing with the edge is computed without a square root, and is precise even where D loses
 * digits by cancellation. */
static struct gd__contest_result contest_equal(const struct gd__window *c,
                                               const struct gd__window *o, double lo, double hi)
{
    struct sample at_lo = sample_at(c, o, lo), at_hi = sample_at(c, o, hi);
    if (at_lo.winner == TIE || at_hi.winner == TIE) return settle_linear_tie(c, o, at_lo, at_hi);
    return at_lo.winner == at_hi.winner ? all_to(at_lo.winner) : split_linearly(at_lo, at_hi);
}

/* Improves the root t by one step of Newton's method on D, if the step is safe. Returns false if t
 * is not a root of D. */
static bool polish(const struct gd__window *c, const struct gd__window *o, double k, double lo,
                   double hi, double *t)
{
    double dc = *t - c->x, d_o = *t - o->x;
    double rc = sqrt(dc * dc + c->y * c->y), ro = sqrt(d_o * d_o + o->y * o->y);
    double residual = rc - ro - k;
    if (fabs(residual) > GD_TOL_ROOT_RESIDUAL * (rc + ro)) return false;
    double product = rc * ro, fall = dc * ro - d_o * rc; /* the slope of D is fall / product */
    if (fabs(fall) <= GD_TOL_POLISH_SLOPE * product) return true;
    double polished = *t - residual * product / fall;
    if (polished > lo && polished < hi && fabs(polished - *t) < GD_TOL_POLISH_STEP * (hi - lo))
        *t = polished;
    return true;
}

/* The squared equation in u = t - lo. With u instead of t, the coefficients are small if a source
 * is close to the interval. Each root is numerator / denominator; if this quotient is not finite,
 * there is no such root. The sign of p u + q determines the branch of the hyperbola. */
struct squared {
    double numerator[2], denominator[2], p, q;
    bool has_roots;
};

static struct squared square(const struct gd__window *c, const struct gd__window *o, double lo)
{
    double xc = c->x - lo, xo = o->x - lo, k = o->sigma - c->sigma, k2 = k * k;
    double p = 2 * (xo - xc), q = (xc - xo) * (xc + xo) + (c->y - o->y) * (c->y + o->y), s = q + k2;
    double a = 4 * k2 - p * p, b = 4 * k2 * xc + p * s,
           e = 4 * k2 * (xc * xc + c->y * c->y) - s * s; /* the equation is a u^2 - 2 b u + e = 0 */
    double discriminant = b * b - a * e, r = sqrt(discriminant > 0 ? discriminant : 0),
           z = b >= 0 ? b + r : b - r;
    return (struct squared){.numerator = {z, e},
                            .denominator = {a, z},
                            .p = p,
                            .q = q,
                            .has_roots = !(discriminant < -GD_TOL_DISCRIMINANT * b * b)};
}

/* Returns true if n / d lies in (0, span) and on the branch. Compares without a division. */
static bool is_on_branch(const struct squared *s, double n, double d, double span, double sign,
                         double least)
{
    double up = d < 0 ? -n : n, size = fabs(d);
    if (!(up > 0 && up < span * size)) return false;
    return (s->p * up + s->q * size) * sign >= least * size;
}

/* Sorts up to two roots. Two roots that are too close together count as one. Returns the number of
 * roots. */
static int sort_roots(double root[2], int count, double span)
{
    if (count < 2) return count;
    if (root[0] > root[1]) {
        double t = root[0];
        root[0] = root[1];
        root[1] = t;
    }
    return root[1] - root[0] < GD_TOL_ROOT_SEPARATION * span ? 1 : 2;
}

/* Computes the roots of D in (lo, hi) for point sources of unequal sigma, in increasing order.
 * Returns their number. */
static int roots_of_points(const struct gd__window *c, const struct gd__window *o, double lo,
                           double hi, double root[2])
{
    struct squared s = square(c, o, lo);
    if (!s.has_roots) return 0;
    double k = o->sigma - c->sigma, span = hi - lo,
           slack = GD_TOL_BRANCH * (fabs(s.q) + fabs(s.p) * span);
    int count = 0;
    for (int i = 0; i < 2; i++) {
        if (!is_on_branch(&s, s.numerator[i], s.denominator[i], span, copysign(1, k),
                          k * k - slack))
            continue;
        double t = lo + s.numerator[i] / s.denominator[i];
        if (t > lo && t < hi && polish(c, o, k, lo, hi, &t)) root[count++] = t;
    }
    return sort_roots(root, count, span);
}

/* Returns the slope of a window's distance along the edge. */
static double slope_at(const struct gd__window *w, double t)
{
    double d = t - w->x;
    return gd__window_is_linear(w) ? -w->x : d / sqrt(d * d + w->y * w->y);
}

/* Improves a candidate for a root by one step of Newton's method on D, if the step is safe. Returns
 * false if the candidate is not a root. */
static bool settle_root(const struct gd__window *c, const struct gd__window *o, double lo,
                        double hi, double *t)
{
    if (!(*t > lo && *t < hi)) return false;
    double dc = gd__window_distance(c, *t), d_o = gd__window_distance(o, *t), residual = dc - d_o;
    if (fabs(residual) > GD_TOL_ROOT_RESIDUAL * (dc + d_o)) return false;
    double slope = slope_at(c, *t) - slope_at(o, *t), polished = *t - residual / slope;
    if (fabs(slope) > GD_TOL_POLISH_SLOPE && polished > lo && polished < hi &&
        fabs(polished - *t) < GD_TOL_POLISH_STEP * (hi - lo))
        *t = polished;
    return true;
}

/* Computes the roots for a linear window and the window of a point source. Let u = t - lo. The
 * distance of the linear window minus the point's sigma is a - x u. The point is at (p, -y). The
 * equation is (u - p)^2 + y^2 = (a - x u)^2. The vector (x, y) of the linear window has length
 * 1. */
static int roots_of_line(const struct gd__window *line, const struct gd__window *point, double lo,
                         double hi, double root[2])
{
    double a = gd__window_distance(line, lo) - point->sigma, p = point->x - lo;
    double square = line->y * line->y, half = p - a * line->x,
           rest = p * p + point->y * point->y - a * a;
    double discriminant = half * half - square * rest, z;
    if (discriminant < -GD_TOL_DISCRIMINANT * half * half) return 0;
    z = half + copysign(sqrt(discriminant > 0 ? discriminant : 0), half);
    double candidate[2] = {lo + z / square, lo + rest / z};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        double t = candidate[i];
        if (settle_root(line, point, lo, hi, &t)) root[count++] = t;
    }
    return sort_roots(root, count, hi - lo);
}

/* The functions below are compiled twice: with `linear`, for windows that may be linear, and
 * without it, for windows of point sources only, which are far more frequent. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* Computes the roots of D in (lo, hi), in increasing order. Returns their number. */
BOTH_KINDS int roots_of(const struct gd__window *c, const struct gd__window *o, double lo,
                        double hi, bool linear, double root[2])
{
    bool c_is_linear = linear && gd__window_is_linear(c),
         o_is_linear = linear && gd__window_is_linear(o);
    if (!c_is_linear && !o_is_linear) return roots_of_points(c, o, lo, hi, root);
    if (!o_is_linear) return roots_of_line(c, o, lo, hi, root);
    if (!c_is_linear) return roots_of_line(o, c, lo, hi, root);
    root[0] = lo + (gd__window_distance(c, lo) - gd__window_distance(o, lo)) / (c->x - o->x);
    return settle_root(c, o, lo, hi, &root[0]);
}

/* Returns the magnitude that determines the rounding error of a distance. The distance of a linear
 * window is a difference of terms that may be larger than the distance. */
static double size_at(const struct gd__window *w, double t, double distance)
{
    return gd__window_is_linear(w) ? fabs(w->sigma) + fabs(w->x * t) : distance;
}

BOTH_KINDS double difference_at(const struct gd__window *c, const struct gd__window *o, double t,
                                bool linear, double *scale)
{
    double dc = linear ? gd__window_distance(c, t) : gd__window_distance_of_point(c, t);
    double d_o = linear ? gd__window_distance(o, t) : gd__window_distance_of_point(o, t);
    *scale = linear ? size_at(c, t, dc) + size_at(o, t, d_o) : dc + d_o;
    return dc - d_o;
}

BOTH_KINDS enum winner winner_at(const struct gd__window *c, const struct gd__window *o, double t,
                                 bool linear)
{
    double scale, difference = difference_at(c, o, t, linear, &scale);
    return winner_of(difference, scale);
}

/* Returns the parameter at which the winner changes, found by bisection. The caller uses bisection
 * if the winner changes exactly once and the quadratic equation is too ill-conditioned. */
BOTH_KINDS double bisect(const struct gd__window *c, const struct gd__window *o, double lo,
                         double hi, enum winner at_lo, bool linear)
{
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        if (winner_at(c, o, middle, linear) == at_lo)
            lo = middle;
        else
            hi = middle;
    }
    return 0.5 * (lo + hi);
}

/* Returns true if the line through both sources meets the edge in (lo, hi). Otherwise D is
 * monotonic there. Point sources only. */
static bool may_turn(const struct gd__window *c, const struct gd__window *o, double lo, double hi)
{
    double at_lo = (lo - c->x) * o->y - (lo - o->x) * c->y,
           at_hi = (hi - c->x) * o->y - (hi - o->x) * c->y;
    return at_lo * at_hi <= 0;
}

/* Handles contests in which the same window wins at both ends. This window wins the whole interval,
 * unless the other window wins a piece in the middle. */
BOTH_KINDS struct gd__contest_result settle_same_ends(const struct gd__window *c,
                                                      const struct gd__window *o, double lo,
                                                      double hi, enum winner at_ends, bool linear)
{
    struct gd__contest_result result = all_to(at_ends);
    if (!linear && !may_turn(c, o, lo, hi)) return result;
    if (roots_of(c, o, lo, hi, linear, result.at) < 2) return result;
    if (winner_at(c, o, 0.5 * (result.at[0] + result.at[1]), linear) == -at_ends)
        result.switches = 2;
    return result;
}

BOTH_KINDS struct gd__contest_result settle_different_ends(const struct gd__window *c,
                                                           const struct gd__window *o, double lo,
                                                           double hi, enum winner at_lo,
                                                           bool linear)
{
    struct gd__contest_result result = all_to(at_lo);
    int count = roots_of(c, o, lo, hi, linear, result.at);
    if (count == 0) result.at[0] = bisect(c, o, lo, hi, at_lo, linear);
    /* If the winners at the two ends differ, the number of roots is odd. If two roots are found,
     * one of them coincides with an end of the interval up to rounding. The winner in the middle
     * shows which of the two roots this is. */
    if (count == 2 && winner_at(c, o, 0.5 * (result.at[0] + result.at[1]), linear) == at_lo)
        result.at[0] = result.at[1];
    result.switches = 1;
    return result;
}

/* Returns the winner of a piece without a root inside. Compares the windows in the middle of the
 * piece and at its points nearest to the two sources. */
BOTH_KINDS enum winner winner_of_piece(const struct gd__window *c, const struct gd__window *o,
                                       double lo, double hi, bool linear)
{
    /* For a linear window, x is not a position. This does not matter, because any point of the
       piece can be compared. */
    double at[3] = {0.5 * (lo + hi), clamp(c->x, lo, hi), clamp(o->x, lo, hi)};
    for (int i = 0; i < 3; i++) {
        enum winner winner = winner_at(c, o, at[i], linear);
        if (winner != TIE) return winner;
    }
    return OWNER;
}

/* Handles contests with a tie at an end of the interval. Up to rounding, there is a root at this
 * end, which may be missing among the computed roots. So the winner of each piece between roots is
 * determined separately. */
BOTH_KINDS struct gd__contest_result settle_tie(const struct gd__window *c,
                                                const struct gd__window *o, double lo, double hi,
                                                bool linear)
{
    double bound[4] = {lo};
    int count = roots_of(c, o, lo, hi, linear, bound + 1);
    bound[count + 1] = hi;
    enum winner last = winner_of_piece(c, o, lo, bound[1], linear);
    struct gd__contest_result result = all_to(last);
    for (int i = 1; i <= count; i++) {
        enum winner winner = winner_of_piece(c, o, bound[i], bound[i + 1], linear);
        if (winner != last) result.at[result.switches++] = bound[i];
        last = winner;
    }
    return result;
}

BOTH_KINDS struct gd__contest_result contest(const struct gd__window *c, const struct gd__window *o,
                                             double lo, double hi, bool linear)
{
    double scale_lo, scale_hi;
    double d_lo = difference_at(c, o, lo, linear, &scale_lo),
           d_hi = difference_at(c, o, hi, linear, &scale_hi);
    enum winner at_lo = winner_of(d_lo, scale_lo), at_hi = winner_of(d_hi, scale_hi);
    /* in this case D has no root in the interval, because D is 2-Lipschitz */
    if (fabs(d_lo + d_hi) >= 2 * (hi - lo) && at_lo == at_hi) return all_to(at_lo);
    if (at_lo == TIE || at_hi == TIE) return settle_tie(c, o, lo, hi, linear);
    if (at_lo != at_hi) return settle_different_ends(c, o, lo, hi, at_lo, linear);
    return settle_same_ends(c, o, lo, hi, at_lo, linear);
}

static struct gd__contest_result contest_linear(const struct gd__window *c,
                                                const struct gd__window *o, double lo, double hi)
{
    return contest(c, o, lo, hi, true);
}

/* Contests two linear windows. Either one window is nearer at both ends, and thus everywhere
 * between them, or there is exactly one root. */
static struct gd__contest_result contest_lines(const struct gd__window *c,
                                               const struct gd__window *o, double lo, double hi)
{
    enum winner at_lo = winner_at(c, o, lo, true), at_hi = winner_at(c, o, hi, true);
    if (at_lo == at_hi && at_lo != TIE) return all_to(at_lo);
    return contest_linear(c, o, lo, hi);
}

struct gd__contest_result gd__contest(const struct gd__window *challenger,
                                      const struct gd__window *owner, double lo, double hi)
{
    if (gd__source_is_linear(challenger->source & owner->source))
        return contest_lines(challenger, owner, lo, hi);
    if (gd__source_is_linear(challenger->source | owner->source))
        return contest_linear(challenger, owner, lo, hi);
    if (challenger->sigma == owner->sigma) return contest_equal(challenger, owner, lo, hi);
    return contest(challenger, owner, lo, hi, false);
}
