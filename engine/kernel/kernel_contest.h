/* Part of kernel_lanes.h: contests of windows. */
/* The fields of windows that a contest needs. */
struct sources {
    lanes x, y, sigma;
};

/* Computes where the winner of the overlap [lo, hi] changes: the owner o wins up to *at, and the
 * challenger c after *at. If one of them wins everywhere, *at is hi or lo. Returns the lanes of
 * `may` for which *at is valid. The other lanes need window/contest.c, which also explains the
 * formulas. */
static inline mask contest_equal(mask may, struct sources c, struct sources o, lanes lo, lanes hi,
                                 lanes *at)
{
    lanes half = all(0.5), dx = o.x - c.x, dy = (c.y - o.y) * (c.y + o.y);
    lanes value_lo = half * (dx * ((lo - c.x) + (lo - o.x)) + dy),
          value_hi = half * (dx * ((hi - c.x) + (hi - o.x)) + dy);
    lanes far_lo = greater(magnitude(lo - c.x) + c.y, magnitude(lo - o.x) + o.y);
    lanes far_hi = greater(magnitude(hi - c.x) + c.y, magnitude(hi - o.x) + o.y),
          better = all(GD_TOL_BETTER);
    lanes slack_lo = better * (far_lo * (far_lo + c.sigma)),
          slack_hi = better * (far_hi * (far_hi + c.sigma));
    mask owner_first = gt(value_lo, slack_lo), challenger_first = lt(value_lo, all(0) - slack_lo);
    mask owner_last = gt(value_hi, slack_hi), challenger_last = lt(value_hi, all(0) - slack_hi);
    mask first_counts = either(owner_first, challenger_first),
         last_counts = either(owner_last, challenger_last);
    mask decided = either(both(first_counts, last_counts),
                          lt((hi - lo) * all(GD_TOL_TIE_FACTOR), lesser(far_lo, far_hi)));
    mask owner_only = except(decided, either(challenger_first, challenger_last)),
         challenger_only = except(decided, either(owner_first, owner_last));
    lanes t = lo + (hi - lo) * (value_lo / (value_lo - value_hi));
    *at = pick(owner_only, hi, pick(challenger_only, lo, greater(lesser(t, hi), lo)));
    return both(may,
                either(either(owner_only, challenger_only), both(owner_first, challenger_last)));
}

/* Returns the lanes in which one window wins in the middle. In these lanes the difference must have
 * no root in the overlap, so this window wins everywhere. */
static mask contest_middle(mask may, struct sources c, struct sources o, lanes lo, lanes hi,
                           lanes *at)
{
    lanes middle = all(0.5) * (lo + hi), ec = middle - c.x, eo = middle - o.x;
    lanes dc = c.sigma + root(ec * ec + c.y * c.y), d_o = o.sigma + root(eo * eo + o.y * o.y),
          difference = dc - d_o, slack = all(GD_TOL_BETTER) * (dc + d_o);
    mask owner = both(may, gt(difference, slack)),
         challenger = both(may, lt(difference, all(0) - slack));
    *at = pick(owner, hi, pick(challenger, lo, *at));
    return either(owner, challenger);
}

/* Returns true in the lanes where n / d lies in (0, span) and on the branch. Divides nothing. */
static inline mask is_on_branch(lanes p, lanes q, lanes n, lanes d, lanes span, lanes sign,
                                lanes least)
{
    const lanes zero = all(0);
    lanes up = pick(lt(d, zero), zero - n, n), size = magnitude(d);
    return both(both(gt(up, zero), lt(up, span * size)),
                ge((p * up + q * size) * sign, least * size));
}

/* Like contest_equal, for unequal sigma. Handles only the lanes in which the difference has no root
 * in (lo, hi), or one root at which it decreases. */
static inline mask contest_unequal(mask may, struct sources c, struct sources o, lanes lo, lanes hi,
                                   lanes *at)
{
    const lanes zero = all(0);
    lanes xc = c.x - lo, xo = o.x - lo, k = o.sigma - c.sigma, k2 = k * k, k4 = all(4) * k2,
          span = hi - lo;
    lanes p = all(2) * (xo - xc), q = (xc - xo) * (xc + xo) + (c.y - o.y) * (c.y + o.y), s = q + k2,
          yc2 = c.y * c.y;
    lanes a = k4 - p * p, b = k4 * xc + p * s, e = k4 * (xc * xc + yc2) - s * s, b2 = b * b,
          discriminant = b2 - a * e;
    /* the roots: z / a and e / z */
    lanes r = root(greater(discriminant, zero)), z = pick(ge(b, zero), b + r, b - r);
    lanes sign = pick(lt(k, zero), all(-1), all(1)),
          least = k2 - all(GD_TOL_BRANCH) * (magnitude(q) + magnitude(p) * span);
    mask real = ge(discriminant, all(-GD_TOL_DISCRIMINANT) * b2);
    mask first = both(real, is_on_branch(p, q, z, a, span, sign, least)),
         second = both(real, is_on_branch(p, q, e, z, span, sign, least));
    mask some = either(first, second), one = both(may, except(some, both(first, second))),
         none = except(may, some);
    lanes u = pick(first, z, e) / pick(first, a, z);

    lanes dc = u - xc, d_o = u - xo, rc = root(dc * dc + yc2), ro = root(d_o * d_o + o.y * o.y),
          residual = rc - ro - k;
    lanes product = rc * ro, fall = dc * ro - d_o * rc, polished = u - residual * product / fall;
    one = both(one, both(le(magnitude(residual), all(GD_TOL_ROOT_RESIDUAL) * (rc + ro)),
                         lt(fall, all(-GD_TOL_POLISH_SLOPE) * product)));
    mask polish = both(both(gt(polished, zero), lt(polished, span)),
                       lt(magnitude(polished - u), all(GD_TOL_POLISH_STEP) * span));
    *at = lo + pick(polish, polished, u);
    return any(none) ? either(one, contest_middle(none, c, o, lo, hi, at)) : one;
}
