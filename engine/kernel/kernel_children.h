/* Part of kernel_lanes.h: lists of children under construction. Joins windows of one source;
 * contests other windows that overlap. */
/* A list of children under construction. b0, b1, x, y, sigma and source describe the list's last
 * window, with its ends before they were cut. The other numbers describe the window that was
 * offered last. None of these numbers is a vector, because most lists are so short that filling
 * vectors would take more time than it saves. */
struct chain {
    struct gd__children *list;
    double width;
    double b0, b1, x, y, sigma, offered_b0, offered_x, offered_y;
    uint32_t source;
};

static struct chain open_chain(struct gd__children *list, double width)
{
    const double before = -1e300;
    list->count = 0;
    list->tangled = GD_NONE;
    list->tangled_last = 0;
    return (struct chain){list,   width,  before, before, before, before,
                          before, before, before, before, GD_NONE};
}

static inline void tangle(struct chain *chain, uint32_t first, uint32_t last)
{
    if (first < chain->list->tangled) chain->list->tangled = first;
    if (last > chain->list->tangled_last) chain->list->tangled_last = last;
}

/* A compressed group of children. own_b1 is the end of a window before other windows were joined to
 * it. Contests use own_b1, so that the result does not depend on the number of lanes: with fewer
 * lanes, the joined windows may belong to the next group. */
struct group {
    uint32_t count;
    lanes b0, b1, own_b1, x, y, sigma;
    ids source;
};

/* Returns the lanes whose window has the same source as the previous window and starts where that
 * window ends. */
static inline mask find_joined(const struct chain *chain, const struct group *g, mask active)
{
    lanes x = after(chain->offered_x, g->x), y = after(chain->offered_y, g->y),
          tolerance = all(GD_TOL_SAME_SOURCE) * (y + magnitude(x));
    mask same =
        both(active, both(le(magnitude(g->x - x), tolerance), le(magnitude(g->y - y), tolerance)));
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

/* Joins runs of windows of one source into the first window of each run. */
static void join(struct chain *chain, struct group *g, mask joined)
{
    const struct gd__windows *out = &chain->list->at;
    uint32_t active = bits(first_lanes(g->count)), inner = bits(joined),
             ends = active & ~(inner >> 1);
    if (inner & 1) { /* the first run continues the list's last window */
        lanes end = compress(mask_of(ends & -ends), g->b1);
        out->b1[chain->list->count - 1] = first_of(end);
        chain->b1 = first_of(end);
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

/* Contests each window with the previous window if they overlap. Cuts both windows where the winner
 * changes. */
static inline __attribute__((always_inline)) void
resolve(struct chain *chain, struct group *g, lanes b0_before, lanes b1_before, mask overlap)
{
    const struct gd__windows *out = &chain->list->at;
    uint32_t count = chain->list->count;
    struct sources c = {g->x, g->y, g->sigma};
    struct sources o = {after(chain->x, g->x), after(chain->y, g->y),
                        after(chain->sigma, g->sigma)};
    lanes lo = greater(g->b0, b0_before), hi = lesser(g->own_b1, b1_before), at_equal = lo,
          at_unequal = lo;
    mask ordered = both(overlap, both(ge(g->b0, b0_before), ge(g->own_b1, b1_before)));
    if (WITH_LINEAR)
        ordered = except(
            ordered, either(linear_of(g->source), linear_of(ids_after(chain->source, g->source))));
    mask equal = both(ordered, eq(c.sigma, o.sigma)), unequal = except(ordered, equal), cut = equal;
    if (any(equal)) cut = contest_equal(equal, c, o, lo, hi, &at_equal);
    if (any(unequal)) cut = either(cut, contest_unequal(unequal, c, o, lo, hi, &at_unequal));
    lanes at = pick(equal, at_equal, at_unequal);
    g->b0 = pick(cut, at, g->b0);
    g->b1 = pick(mask_ahead(cut), ahead(at), g->b1);
    if (bits(cut) & 1) {
        out->b1[count - 1] = first_of(at);
        if (out->b1[count - 1] - out->b0[count - 1] <= chain->width)
            tangle(chain, count - 1, count - 1);
    }
    mask narrow =
        both(first_lanes(g->count), le(lesser(g->b1, g->own_b1) - g->b0, all(chain->width)));
    mask tangled = either(except(overlap, cut), narrow);
    if (any(tangled)) tangle(chain, count + first_set(tangled), count + last_set(tangled));
}

/* Appends the windows in the mask `keep`. */
static inline void append(struct chain *chain, bool more, bool coalesce, mask keep, lanes b0,
                          lanes b1, lanes x, lanes y, lanes sigma, ids source)
{
    uint32_t set = bits(keep);
    if (!set) return;
    /* members are set one by one, because an initialiser would clear the struct first */
    struct group g;
    g.count = (uint32_t)__builtin_popcount(set);
    g.b0 = b0;
    g.b1 = b1;
    g.x = x;
    g.y = y;
    g.sigma = sigma;
    g.source = source;
    /* the kept lanes are not the first lanes; this is rare on the left side */
    if (set & (set + 1)) {
        g.b0 = compress(keep, b0);
        g.b1 = compress(keep, b1);
        g.x = compress(keep, x);
        g.y = compress(keep, y);
        g.sigma = compress(keep, sigma);
        g.source = ids_compress(keep, source);
    }
    g.own_b1 = g.b1;
    mask joined = coalesce ? find_joined(chain, &g, first_lanes(g.count)) : mask_of(0);
    if (more) {
        chain->offered_b0 = last_of(g.b0, g.count);
        chain->offered_x = last_of(g.x, g.count);
        chain->offered_y = last_of(g.y, g.count);
    }
    if (any(joined)) join(chain, &g, joined);
    if (!g.count) return;
    const struct gd__windows *out = &chain->list->at;
    lanes b0_before = after(chain->b0, g.b0), b1_before = after(chain->b1, g.b1), whole_b0 = g.b0,
          whole_b1 = g.b1;
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

/* Drops windows whose source is on, or almost on, the line of the children's edge. Computes
 * gd__window_grazes for all lanes. */
static inline mask drop_grazing(mask keep, lanes x, lanes y, double length)
{
    const lanes zero = all(0), whole = all(length);
    mask low = both(keep, le(y, all(GD_TOL_GRAZING * length)));
    mask beside =
        either(lt(x, all(-GD_TOL_BESIDE * length)), gt(x, all((1 + GD_TOL_BESIDE) * length)));
    mask on_line = both(eq(y, zero), either(le(x, zero), ge(x, whole)));
    return except(keep, both(low, either(lt(y, zero), either(beside, on_line))));
}

static inline mask wide_enough(mask may, lanes t0, lanes t1, lanes x, lanes y, double length,
                               mask linear)
{
    mask keep = both(may, gt(t1 - t0, all(GD_TOL_WIDTH * length)));
    /* for a linear window, y is a coordinate of a unit vector, so its bound does not depend on the
       length */
    if (WITH_LINEAR) {
        keep = except(keep, both(linear, le(y, all(GD_TOL_GRAZING))));
        y = pick(linear, all(length), y);
    }
    if (any(both(keep, le(y, all(GD_TOL_GRAZING * length)))))
        keep = drop_grazing(keep, x, y, length);
    return keep;
}
