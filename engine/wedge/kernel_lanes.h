/* The kernel for one set of lanes; included by kernel_plain.c, kernel_avx2.c and kernel_avx512.c behind their lanes_*.h, and once more by
 * kernel_linear_plain.c and so on with WITH_LINEAR 1: what concerns linear windows is left out of the former.
 *
 * LANES doubles make one `lanes`, their 32-bit companions `ids`, a truth value a lane `mask`. Arithmetic is written with C's operators; of the
 * functions, `pick` chooses by lane, `compress` moves the lanes of a mask to the front, `after(carry, a)` moves all lanes one up and takes the
 * carry's last one in, `ahead` moves them one down, `last_of` spreads lane count - 1. bits and mask_of convert a mask to and from an integer.
 *
 * In a side's frame the apex is p = (px, py), a source (x, -y). For a point (b, 0) of the edge, k(b) = (b - x)(py + y) - y (px - x) is negative
 * when the ray through it passes left of p. */
#include "base/tolerance.h"
#include "wedge/kernel.h"

static inline mask ge(lanes a, lanes b)
{
    return le(b, a);
}

static inline mask gt(lanes a, lanes b)
{
    return lt(b, a);
}

static inline bool any(mask m)
{
    return bits(m) != 0;
}

/* The lowest lane that is set. */
static inline uint32_t first_set(mask m)
{
    return (uint32_t)__builtin_ctz(bits(m));
}

static inline uint32_t last_set(mask m)
{
    return 31 - (uint32_t)__builtin_clz(bits(m));
}

/* Lanes whose windows are linear (wedge/window.h). */
static inline mask linear_of(ids source)
{
#if WITH_LINEAR
    return ids_top(source);
#else
    (void)source;
    return mask_of(0);
#endif
}

/* --- filters ------------------------------------------------------------------------------------------------------------- */

/* Moves the windows of `keep` from place `from` to place `to` <= from. */
static uint32_t close_ranks(const struct gd__windows *w, uint32_t from, uint32_t to, mask keep)
{
    store(w->b0 + to, compress(keep, load(w->b0 + from)));
    store(w->b1 + to, compress(keep, load(w->b1 + from)));
    store(w->x + to, compress(keep, load(w->x + from)));
    store(w->y + to, compress(keep, load(w->y + from)));
    store(w->sigma + to, compress(keep, load(w->sigma + from)));
    ids_store(w->source + to, ids_compress(keep, ids_load(w->source + from)));
    return to + (uint32_t)__builtin_popcount(bits(keep));
}

/* Trims windows at places [i, i + LANES) where the way round an end becomes shorter inside. */
static void trim(const struct gd__windows *w, uint32_t i, mask first, mask last, double length, lanes c0, lanes c1)
{
    lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), x = load(w->x + i), y = load(w->y + i);
    lanes square = x * x + y * y, two = all(2), c = c1 + all(length);
    lanes t = (square - c0 * c0) / (two * (c0 + x));
    if (WITH_LINEAR) t = pick(linear_of(ids_load(w->source + i)), (all(0) - c0) / (all(1) + x), t);
    b0 = pick(both(first, both(gt(t, b0), lt(t, b1))), t, b0);
    t = (c * c - square) / (two * (c - x));
    if (WITH_LINEAR) t = pick(linear_of(ids_load(w->source + i)), c / (all(1) - x), t);
    b1 = pick(both(last, both(lt(t, b1), gt(t, b0))), t, b1);
    store(w->b0 + i, b0);
    store(w->b1 + i, b1);
}

static uint32_t filter(const struct gd__windows *w, uint32_t count, double length, double d0, double d1)
{
    const lanes zero = all(0), at_origin = all(d0), at_destination = all(d1), whole = all(length);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += LANES) {
        mask active = first_lanes(count - i);
        lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), x = load(w->x + i), y = load(w->y + i),
              sigma = load(w->sigma + i);
        lanes e0 = b0 - x, e1 = b1 - x, y2 = y * y, r0 = e0 * e0 + y2, r1 = e1 * e1 + y2;
        lanes slack = all(GD_TOL_BETTER) * (sigma + whole + magnitude(x) + y);
        lanes c0 = at_origin - sigma, c1 = at_destination - sigma, back0 = c0 + slack, back1 = c1 + whole + slack;
        lanes far0 = back0 + b1, far1 = back1 - b0, near0 = back0 + b0, near1 = back1 - b1;
        mask drop = either(either(lt(far0, zero), gt(r1, far0 * far0)), either(lt(far1, zero), gt(r0, far1 * far1)));
        mask first = both(active, either(lt(near0, zero), gt(r0, near0 * near0)));
        mask last = both(active, either(lt(near1, zero), gt(r1, near1 * near1)));
        if (WITH_LINEAR) {
            mask linear = both(active, linear_of(ids_load(w->source + i)));
            lanes more = all(GD_TOL_BETTER) * (magnitude(sigma) - sigma), l0 = zero - x * b0 - more,
                  l1 = zero - x * b1 - more;
            drop = either(except(drop, linear), both(linear, either(gt(l1, far0), gt(l0, far1))));
            first = either(except(first, linear), both(linear, gt(l0, near0)));
            last = either(except(last, linear), both(linear, gt(l1, near1)));
        }
        drop = both(active, drop);
        if (any(either(first, last))) trim(w, i, except(first, drop), except(last, drop), length, c0, c1);
        if (any(drop) || kept != i)
            kept = close_ranks(w, i, kept, except(active, drop));
        else
            kept += count - i < LANES ? count - i : LANES;
    }
    return kept;
}

static uint32_t within(const struct gd__windows *w, uint32_t count, double bound)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += LANES) {
        lanes x = load(w->x + i), y = load(w->y + i);
        lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), sigma = load(w->sigma + i);
        lanes d = lesser(greater(x, b0), b1) - x, nearest = root(d * d + y * y);
        if (WITH_LINEAR) nearest = pick(linear_of(ids_load(w->source + i)), all(0) - greater(x * b0, x * b1), nearest);
        mask near = le(sigma + nearest, all(bound));
        kept = close_ranks(w, i, kept, both(first_lanes(count - i), near));
    }
    return kept;
}

/* --- storing ------------------------------------------------------------------------------------------------------------- */

/* No start lies behind the end of the one before by more than what counts as adjacent, and the first and the last reach the edge's ends. */
static inline mask gap_before(lanes b0, lanes end_before, lanes tolerance)
{
    return gt(b0, end_before + tolerance);
}

/* Starts of wedges, in units of 2^-32 of the edge; of those in `at_end` that is the edge's end, whatever rounding made of it. */
static inline lanes starts_of(lanes b, double scale, mask at_end)
{
    return pick(at_end, all(0), lesser(greater(b * all(scale), all(0)), all(GD__WEDGE_LATEST)));
}

/* Whether there is a gap between two of the windows; and whether there is one before the first and behind the last. */
static bool has_gaps(const struct gd__windows *w, uint32_t count, double length, bool *before, bool *behind)
{
    const lanes tolerance = all(GD_TOL_ADJACENT * length);
    lanes end = all(w->b0[0]);
    for (uint32_t i = 0; i < count; i += LANES) {
        uint32_t active = count - i < LANES ? count - i : LANES;
        lanes b1 = load(w->b1 + i);
        if (any(both(first_lanes(active), gap_before(load(w->b0 + i), after(end, b1), tolerance)))) return true;
        end = last_of(b1, active);
    }
    *before = w->b0[0] > GD_TOL_ADJACENT * length;
    *behind = first_of(end) + GD_TOL_ADJACENT * length < length;
    return false;
}

static void store_straight(const struct gd__windows *w, uint32_t count, double length, bool gap, struct gd__wedges to)
{
    const double scale = GD__WEDGE_UNITS / length;
    for (uint32_t i = 0; i < count; i += LANES) {
        store_first(to.x + i, load(w->x + i), count - i);
        store_first(to.y + i, all(-0.0) - load(w->y + i), count - i);
        store_starts(to.start + i, starts_of(load(w->b0 + i), scale, mask_of(i == 0 && !gap)), ids_load(w->source + i),
                     count - i);
    }
}

/* From the last window to the first; groups begin before the list for the last of them, where a block's own arrays or its header lie. */
static void store_mirrored(const struct gd__windows *w, uint32_t count, double length, bool gap, struct gd__wedges to)
{
    const double scale = GD__WEDGE_UNITS / length;
    const lanes whole = all(length);
    for (uint32_t i = 0; i < count; i += LANES) {
        ptrdiff_t at = (ptrdiff_t)count - i - LANES;
        store_first(to.x + i, reversed(whole - load(w->x + at)), count - i);
        store_first(to.y + i, reversed(load(w->y + at)), count - i);
        store_starts(to.start + i, starts_of(reversed(whole - load(w->b1 + at)), scale, mask_of(i == 0 && !gap)),
                     ids_reversed(ids_load(w->source + at)), count - i);
    }
}

static void store_gap(struct gd__wedges to, uint32_t at, double b, double length)
{
    double start = b * (GD__WEDGE_UNITS / length);
    to.x[at] = to.y[at] = 0;
    to.start[at] = (uint64_t)(start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST) | (uint64_t)GD_NONE << 32;
}

static uint32_t store_wedges(const struct gd__windows *w, uint32_t count, double length, bool mirrored, double *data)
{
    bool before, behind;
    if (WITH_LINEAR || has_gaps(w, count, length, &before, &behind))
        return 0; /* linear: in another form, see wedges.c */
    bool first = mirrored ? behind : before, last = mirrored ? before : behind;
    uint32_t total = count + first + last;
    struct gd__wedges whole = gd__wedges_at(data, total), to = {whole.x + first, whole.y + first, whole.start + first};
    if (mirrored)
        store_mirrored(w, count, length, first, to);
    else
        store_straight(w, count, length, first, to);
    if (first) store_gap(whole, 0, 0, length);
    if (last) store_gap(whole, total - 1, mirrored ? length - w->b0[0] : w->b1[count - 1], length);
    return total;
}

/* --- contests ------------------------------------------------------------------------------------------------------------ */

/* Windows as far as a contest needs them. */
struct sources {
    lanes x, y, sigma;
};

/* A tie at an end says nothing of an overlap that is wide against the distance of the sources; in one so many times narrower it holds all along. */
#define NARROW 1024

/* Where the overlap [lo, hi] changes hands: up to there the owner o is better, from there on the challenger c; hi or lo where one of them is better all
 * along. Returns the lanes of `may` for which *at says it; for the others contest.c has to. It has the same formulas with their reasons. */
static inline mask contest_equal(mask may, struct sources c, struct sources o, lanes lo, lanes hi, lanes *at)
{
    lanes half = all(0.5), dx = o.x - c.x, dy = (c.y - o.y) * (c.y + o.y);
    lanes value_lo = half * (dx * ((lo - c.x) + (lo - o.x)) + dy),
          value_hi = half * (dx * ((hi - c.x) + (hi - o.x)) + dy);
    lanes far_lo = greater(magnitude(lo - c.x) + c.y, magnitude(lo - o.x) + o.y);
    lanes far_hi = greater(magnitude(hi - c.x) + c.y, magnitude(hi - o.x) + o.y), better = all(GD_TOL_BETTER);
    lanes slack_lo = better * (far_lo * (far_lo + c.sigma)), slack_hi = better * (far_hi * (far_hi + c.sigma));
    mask owner_first = gt(value_lo, slack_lo), challenger_first = lt(value_lo, all(0) - slack_lo);
    mask owner_last = gt(value_hi, slack_hi), challenger_last = lt(value_hi, all(0) - slack_hi);
    mask first_counts = either(owner_first, challenger_first), last_counts = either(owner_last, challenger_last);
    mask decided = either(both(first_counts, last_counts), lt((hi - lo) * all(NARROW), lesser(far_lo, far_hi)));
    mask owner_only = except(decided, either(challenger_first, challenger_last)),
         challenger_only = except(decided, either(owner_first, owner_last));
    lanes t = lo + (hi - lo) * (value_lo / (value_lo - value_hi));
    *at = pick(owner_only, hi, pick(challenger_only, lo, greater(lesser(t, hi), lo)));
    return both(may, either(either(owner_only, challenger_only), both(owner_first, challenger_last)));
}

/* The lanes in which one of the two is better in the middle, for where the difference has no root: then it is better all along. */
static mask contest_middle(mask may, struct sources c, struct sources o, lanes lo, lanes hi, lanes *at)
{
    lanes middle = all(0.5) * (lo + hi), ec = middle - c.x, eo = middle - o.x;
    lanes dc = c.sigma + root(ec * ec + c.y * c.y), d_o = o.sigma + root(eo * eo + o.y * o.y), difference = dc - d_o,
          slack = all(GD_TOL_BETTER) * (dc + d_o);
    mask owner = both(may, gt(difference, slack)), challenger = both(may, lt(difference, all(0) - slack));
    *at = pick(owner, hi, pick(challenger, lo, *at));
    return either(owner, challenger);
}

/* Whether n / d lies in (0, span) and on the branch; asked without dividing. */
static inline mask is_on_branch(lanes p, lanes q, lanes n, lanes d, lanes span, lanes sign, lanes least)
{
    const lanes zero = all(0);
    lanes up = pick(lt(d, zero), zero - n, n), size = magnitude(d);
    return both(both(gt(up, zero), lt(up, span * size)), ge((p * up + q * size) * sign, least * size));
}

/* The same for unequal sigma: the difference falls at one root in (lo, hi), or there is none. */
static inline mask contest_unequal(mask may, struct sources c, struct sources o, lanes lo, lanes hi, lanes *at)
{
    const lanes zero = all(0);
    lanes xc = c.x - lo, xo = o.x - lo, k = o.sigma - c.sigma, k2 = k * k, k4 = all(4) * k2, span = hi - lo;
    lanes p = all(2) * (xo - xc), q = (xc - xo) * (xc + xo) + (c.y - o.y) * (c.y + o.y), s = q + k2, yc2 = c.y * c.y;
    lanes a = k4 - p * p, b = k4 * xc + p * s, e = k4 * (xc * xc + yc2) - s * s, b2 = b * b, discriminant = b2 - a * e;
    lanes r = root(greater(discriminant, zero)), z = pick(ge(b, zero), b + r, b - r); /* the roots: z / a and e / z */
    lanes sign = pick(lt(k, zero), all(-1), all(1)),
          least = k2 - all(GD_TOL_BRANCH) * (magnitude(q) + magnitude(p) * span);
    mask real = ge(discriminant, all(-GD_TOL_DISCRIMINANT) * b2);
    mask first = both(real, is_on_branch(p, q, z, a, span, sign, least)),
         second = both(real, is_on_branch(p, q, e, z, span, sign, least));
    mask some = either(first, second), one = both(may, except(some, both(first, second))), none = except(may, some);
    lanes u = pick(first, z, e) / pick(first, a, z);

    lanes dc = u - xc, d_o = u - xo, rc = root(dc * dc + yc2), ro = root(d_o * d_o + o.y * o.y), residual = rc - ro - k;
    lanes product = rc * ro, fall = dc * ro - d_o * rc, polished = u - residual * product / fall;
    one = both(one, both(le(magnitude(residual), all(GD_TOL_ROOT_RESIDUAL) * (rc + ro)),
                         lt(fall, all(-GD_TOL_POLISH_SLOPE) * product)));
    mask polish =
        both(both(gt(polished, zero), lt(polished, span)), lt(magnitude(polished - u), all(GD_TOL_POLISH_STEP) * span));
    *at = lo + pick(polish, polished, u);
    return any(none) ? either(one, contest_middle(none, c, o, lo, hi, at)) : one;
}

/* --- children ------------------------------------------------------------------------------------------------------------ */

/* A list of children while it is built: the last window (as it was before its successor cut it) in all lanes, and where the source of the last
 * one that was offered lies, joined or not. */
struct chain {
    struct gd__children *list;
    double width;
    lanes b0, b1, x, y, sigma, offered_b0, offered_x, offered_y;
    ids source;
};

static struct chain open_chain(struct gd__children *list, double width)
{
    lanes before = all(-1e300);
    list->count = 0;
    list->tangled = GD_NONE;
    list->tangled_last = 0;
    return (struct chain){list,   width,  before, before, before,          before,
                          before, before, before, before, ids_all(GD_NONE)};
}

static inline void tangle(struct chain *chain, uint32_t first, uint32_t last)
{
    if (first < chain->list->tangled) chain->list->tangled = first;
    if (last > chain->list->tangled_last) chain->list->tangled_last = last;
}

/* A group of children, compressed. own_b1: before others were joined to it, which is what it is contested by: the others may come in the next group. */
struct group {
    uint32_t count;
    lanes b0, b1, own_b1, x, y, sigma;
    ids source;
};

/* Lanes that see the source of the window before them and go on where it ends. */
static inline mask find_joined(const struct chain *chain, const struct group *g, mask active)
{
    lanes x = after(chain->offered_x, g->x), y = after(chain->offered_y, g->y),
          tolerance = all(GD_TOL_SAME_SOURCE) * (y + magnitude(x));
    mask same = both(active, both(le(magnitude(g->x - x), tolerance), le(magnitude(g->y - y), tolerance)));
    if (!any(same)) return same;
    lanes sigma = after(chain->sigma, g->sigma);
    mask as_far = eq(g->sigma, sigma);
    if (WITH_LINEAR) {
        lanes slack = all(GD_TOL_SAME_SOURCE) * (magnitude(sigma) + magnitude(g->b1));
        as_far = either(as_far, both(linear_of(g->source), le(magnitude(g->sigma - sigma), slack)));
    }
    same = both(same, both(ids_eq(g->source, ids_after(chain->source, g->source)), as_far));
    lanes b0 = after(chain->offered_b0, g->b0), b1 = after(chain->b1, g->b1);
    lanes reach = g->b0 - all(GD_TOL_ADJACENT) * (g->b1 - g->b0) - all(chain->width);
    return both(same, both(ge(b1, reach), both(le(b0, g->b0), ge(g->b1, b1))));
}

/* Joins runs of windows into their first ones. */
static void join(struct chain *chain, struct group *g, mask joined)
{
    const struct gd__windows *out = &chain->list->at;
    uint32_t active = bits(first_lanes(g->count)), inner = bits(joined), ends = active & ~(inner >> 1);
    if (inner & 1) { /* the first run goes on with the list's last window */
        lanes end = compress(mask_of(ends & -ends), g->b1);
        out->b1[chain->list->count - 1] = first_of(end);
        chain->b1 = last_of(end, 1);
        ends &= ends - 1;
    }
    mask starts = mask_of(active & ~inner);
    g->count = (uint32_t)__builtin_popcount(active & ~inner);
    g->b0 = compress(starts, g->b0);
    g->own_b1 = compress(starts, g->b1);
    g->b1 = compress(mask_of(ends), g->b1);
    g->x = compress(starts, g->x);
    g->y = compress(starts, g->y);
    g->sigma = compress(starts, g->sigma);
    g->source = ids_compress(starts, g->source);
}

/* Contests each window with the one before it where they overlap, and cuts both where the overlap changes hands. */
static inline __attribute__((always_inline)) void resolve(struct chain *chain, struct group *g, lanes b0_before,
                                                          lanes b1_before, mask overlap)
{
    const struct gd__windows *out = &chain->list->at;
    uint32_t count = chain->list->count;
    struct sources c = {g->x, g->y, g->sigma};
    struct sources o = {after(chain->x, g->x), after(chain->y, g->y), after(chain->sigma, g->sigma)};
    lanes lo = greater(g->b0, b0_before), hi = lesser(g->own_b1, b1_before), at_equal = lo, at_unequal = lo;
    mask ordered = both(overlap, both(ge(g->b0, b0_before), ge(g->own_b1, b1_before)));
    if (WITH_LINEAR)
        ordered = except(ordered, either(linear_of(g->source), linear_of(ids_after(chain->source, g->source))));
    mask equal = both(ordered, eq(c.sigma, o.sigma)), unequal = except(ordered, equal), cut = equal;
    if (any(equal)) cut = contest_equal(equal, c, o, lo, hi, &at_equal);
    if (any(unequal)) cut = either(cut, contest_unequal(unequal, c, o, lo, hi, &at_unequal));
    lanes at = pick(equal, at_equal, at_unequal);
    g->b0 = pick(cut, at, g->b0);
    g->b1 = pick(mask_ahead(cut), ahead(at), g->b1);
    if (bits(cut) & 1) {
        out->b1[count - 1] = first_of(at);
        if (out->b1[count - 1] - out->b0[count - 1] <= chain->width) tangle(chain, count - 1, count - 1);
    }
    mask narrow = both(first_lanes(g->count), le(lesser(g->b1, g->own_b1) - g->b0, all(chain->width)));
    mask tangled = either(except(overlap, cut), narrow);
    if (any(tangled)) tangle(chain, count + first_set(tangled), count + last_set(tangled));
}

/* Appends the windows of `keep`. */
static inline void append(struct chain *chain, bool more, bool coalesce, mask keep, lanes b0, lanes b1, lanes x,
                          lanes y, lanes sigma, ids source)
{
    uint32_t set = bits(keep);
    if (!set) return;
    struct group g; /* field by field: an initialiser would clear it first */
    g.count = (uint32_t)__builtin_popcount(set);
    g.b0 = b0;
    g.b1 = b1;
    g.x = x;
    g.y = y;
    g.sigma = sigma;
    g.source = source;
    if (set & (set + 1)) { /* not the first ones: seldom so on the left */
        g.b0 = compress(keep, b0);
        g.b1 = compress(keep, b1);
        g.x = compress(keep, x);
        g.y = compress(keep, y);
        g.sigma = compress(keep, sigma);
        g.source = ids_compress(keep, source);
    }
    g.own_b1 = g.b1;
    lanes offered_b0 = last_of(g.b0, g.count), offered_x = last_of(g.x, g.count), offered_y = last_of(g.y, g.count);
    if (coalesce) {
        mask joined = find_joined(chain, &g, first_lanes(g.count));
        if (any(joined)) join(chain, &g, joined);
    }
    if (more) {
        chain->offered_b0 = offered_b0;
        chain->offered_x = offered_x;
        chain->offered_y = offered_y;
    }
    if (!g.count) return;
    const struct gd__windows *out = &chain->list->at;
    lanes b0_before = after(chain->b0, g.b0), b1_before = after(chain->b1, g.b1), whole_b0 = g.b0, whole_b1 = g.b1;
    mask overlap = both(first_lanes(g.count), gt(b1_before - g.b0, all(chain->width)));
    if (any(overlap)) resolve(chain, &g, b0_before, b1_before, overlap);
    uint32_t count = chain->list->count;
    store(out->b0 + count, g.b0);
    store(out->b1 + count, g.b1);
    store(out->x + count, g.x);
    store(out->y + count, g.y);
    store(out->sigma + count, g.sigma);
    ids_store(out->source + count, g.source);
    chain->list->count = count + g.count;
    if (!more) return;
    chain->b0 = last_of(whole_b0, g.count);
    chain->b1 = last_of(whole_b1, g.count);
    chain->x = last_of(g.x, g.count);
    chain->y = last_of(g.y, g.count);
    chain->sigma = last_of(g.sigma, g.count);
    chain->source = ids_last_of(g.source, g.count);
}

/* A source at or beside the line of the children's edge: gd__window_grazes in lanes. */
static inline mask drop_grazing(mask keep, lanes x, lanes y, double length)
{
    const lanes zero = all(0), whole = all(length);
    mask low = both(keep, le(y, all(GD_TOL_GRAZING * length)));
    mask beside = either(lt(x, all(-GD_TOL_BESIDE * length)), gt(x, all((1 + GD_TOL_BESIDE) * length)));
    mask on_line = both(eq(y, zero), either(le(x, zero), ge(x, whole)));
    return except(keep, both(low, either(lt(y, zero), either(beside, on_line))));
}

static inline mask wide_enough(mask may, lanes t0, lanes t1, lanes x, lanes y, double length, mask linear)
{
    mask keep = both(may, gt(t1 - t0, all(GD_TOL_WIDTH * length)));
    if (WITH_LINEAR) { /* their y is of a unit vector */
        keep = except(keep, both(linear, le(y, all(GD_TOL_GRAZING))));
        y = pick(linear, all(length), y);
    }
    if (any(both(keep, le(y, all(GD_TOL_GRAZING * length))))) keep = drop_grazing(keep, x, y, length);
    return keep;
}

/* --- casting ------------------------------------------------------------------------------------------------------------- */

/* Offers the apex the lengths of straight ways, by turns. They are few: a root for all lanes would take longer than theirs. */
static inline void reach_straight(struct gd__apex *apex, const struct gd__windows *w, uint32_t i, mask offers,
                                  double px, double py)
{
    for (uint32_t left = bits(offers); left; left &= left - 1) {
        uint32_t at = i + (uint32_t)__builtin_ctz(left);
        struct gd__window window = {.x = w->x[at], .y = w->y[at], .sigma = w->sigma[at]};
#if WITH_LINEAR
        window.source = w->source[at];
#endif
        double distance = gd__window_distance_beyond(&window, px, py);
        if (distance >= apex->distance * (1 - GD_TOL_BETTER)) continue;
        apex->distance = distance;
        apex->improved = true;
        apex->x = w->x[at];
        apex->y = w->y[at];
        apex->source = w->source[at];
    }
}

/* A direction stays of unit length, whatever rounding makes of it across many narrow faces. */
static inline void keep_unit(mask linear, lanes *x, lanes *y)
{
    lanes scale = pick(linear, all(1) / root(*x * *x + *y * *y), all(1));
    *x = *x * scale;
    *y = *y * scale;
}

/* a / b and c / d by one division, the dearest operation of all. */
static inline void quotients(lanes a, lanes b, lanes c, lanes d, lanes *first, lanes *second)
{
    lanes inverse = all(1) / (b * d);
    *first = a * (d * inverse);
    *second = c * (b * inverse);
}

static void cast(const struct gd_side *side, const struct gd__windows *w, uint32_t count, bool coalesce,
                 struct gd__apex *apex, struct gd__children *left_list, struct gd__children *right_list)
{
    const double left_length = side->left_length, right_length = side->right_length;
    const double apex_x = left_length * side->left_x, apex_y = left_length * side->left_y;
    const lanes zero = all(0), px = all(apex_x), py = all(apex_y), whole = all(side->length);
    const lanes ux = all(side->left_x), uy = all(side->left_y), vx = all(side->right_x), vy = all(side->right_y);
    struct chain left = open_chain(left_list, GD_TOL_WIDTH * left_length),
                 right = open_chain(right_list, GD_TOL_WIDTH * right_length);
    uint32_t last_left = GD_NONE, first_right = GD_NONE;
    bool seen = false;
    for (uint32_t i = 0; i < count; i += LANES) {
        const bool more = i + LANES < count;
        mask active = first_lanes(count - i);
        lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), x = load(w->x + i), y = load(w->y + i),
              sigma = load(w->sigma + i);
        ids source = ids_load(w->source + i);
        lanes e0 = b0 - x, e1 = b1 - x, hx = px - x, hy = py + y, turn = y * hx, k0 = e0 * hy - turn,
              k1 = e1 * hy - turn;
        mask linear = linear_of(source);
        lanes beyond = zero; /* what a linear window's distance grows by from the frame's origin to the apex */
        if (WITH_LINEAR) {
            beyond = y * py - x * px;
            k0 = pick(linear, y * (b0 - px) - x * py, k0);
            k1 = pick(linear, y * (b1 - px) - x * py, k1);
            e0 = pick(linear, zero - x, e0);
            e1 = pick(linear, zero - x, e1);
        }

        mask passes_left = both(active, lt(k1, zero)), passes_right = both(active, gt(k0, zero)),
             straight = except(active, either(passes_left, passes_right));
        if (any(straight)) {
            seen = true;
            reach_straight(apex, w, i, straight, apex_x, apex_y);
        }
        last_left = any(passes_left) ? i + last_set(passes_left) : last_left;
        first_right = any(passes_right) && first_right == GD_NONE ? i + first_set(passes_right) : first_right;

        mask to_left = both(active, lt(k0, zero));
        if (any(to_left)) {
            lanes yl = uy * x + ux * y, xl = x * ux - y * uy, back = y * ux, minus_y = zero - y;
            if (WITH_LINEAR) keep_unit(linear, &xl, &yl);
            mask from_origin = le(b0, zero), to_apex = ge(k1, zero);
            lanes t0, t1;
            quotients(b0 * minus_y, pick(from_origin, all(1), e0 * uy - back), b1 * minus_y,
                      pick(to_apex, all(1), e1 * uy - back), &t0, &t1);
            t0 = pick(except(ge(t0, zero), from_origin), t0, zero);
            t1 = pick(except(le(t1, all(left_length)), to_apex), t1, all(left_length));
            append(&left, more, coalesce, wide_enough(to_left, t0, t1, xl, yl, left_length, linear), t0, t1, xl, yl,
                   sigma, source);
        }
        mask to_right = both(active, gt(k1, zero));
        if (any(to_right)) {
            lanes rx = x - px, ry = zero - y - py, farther = sigma;
            if (WITH_LINEAR) {
                rx = pick(linear, x, rx);
                ry = pick(linear, zero - y, ry);
                farther = pick(linear, sigma + beyond, sigma);
            }
            lanes yr = vy * rx - vx * ry, xr = rx * vx + ry * vy, back = y * vx;
            if (WITH_LINEAR) keep_unit(linear, &xr, &yr);
            mask from_apex = le(k0, zero), to_end = ge(b1, whole);
            lanes t0, t1;
            quotients(zero - k0, pick(from_apex, all(1), e0 * vy - back), zero - k1,
                      pick(to_end, all(1), e1 * vy - back), &t0, &t1);
            t0 = pick(except(ge(t0, zero), from_apex), t0, zero);
            t1 = pick(except(le(t1, all(right_length)), to_end), t1, all(right_length));
            append(&right, more, coalesce, wide_enough(to_right, t0, t1, xr, yr, right_length, linear), t0, t1, xr, yr,
                   farther, source);
        }
    }
    apex->last_left = seen ? GD_NONE : last_left;
    apex->first_right = seen ? GD_NONE : first_right;
}

#if WITH_LINEAR
const struct gd__kernel KERNEL_LINEAR(kernel) = {
#else
const struct gd__kernel KERNEL(kernel) = {
#endif
    .name = KERNEL_NAME, .filter = filter, .within = within, .store = store_wedges, .cast = cast};
