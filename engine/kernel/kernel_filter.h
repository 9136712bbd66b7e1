/* Part of kernel_lanes.h: filters windows. */
/* Moves the windows in the mask `keep` from index `from` to index `to` <= `from`. */
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

/* Trims the windows at indices [i, i + LANES) at the point where the path around an end of the edge
 * becomes shorter. If the source lies close to this end, both distances are nearly equal, so the
 * formula must not subtract squares of lengths. */
static void trim(const struct gd__windows *w, uint32_t i, mask first, mask last, double length,
                 lanes c0, lanes c1)
{
    lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), x = load(w->x + i), y = load(w->y + i);
    lanes half = all(0.5), back = all(length) - x, c = c1 + all(length), y2 = y * y;
    lanes t = half * ((x - c0) + y2 / (x + c0));
    if (WITH_LINEAR) t = pick(linear_of(ids_load(w->source + i)), (all(0) - c0) / (all(1) + x), t);
    b0 = pick(both(first, both(gt(t, b0), lt(t, b1))), t, b0);
    t = half * ((c + x) - y2 / (c1 + back));
    if (WITH_LINEAR) t = pick(linear_of(ids_load(w->source + i)), c / (all(1) - x), t);
    b1 = pick(both(last, both(lt(t, b1), gt(t, b0))), t, b1);
    store(w->b0 + i, b0);
    store(w->b1 + i, b1);
}

static uint32_t filter(const struct gd__windows *w, uint32_t count, double length, double d0,
                       double d1)
{
    const lanes zero = all(0), at_origin = all(d0), at_destination = all(d1), whole = all(length);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += LANES) {
        mask active = first_lanes(count - i);
        lanes b0 = load(w->b0 + i), b1 = load(w->b1 + i), x = load(w->x + i), y = load(w->y + i),
              sigma = load(w->sigma + i);
        lanes e0 = b0 - x, e1 = b1 - x, y2 = y * y, r0 = e0 * e0 + y2, r1 = e1 * e1 + y2;
        lanes slack = all(GD_TOL_BETTER) * (sigma + whole + magnitude(x) + y);
        lanes c0 = at_origin - sigma, c1 = at_destination - sigma, back0 = c0 + slack,
              back1 = c1 + whole + slack;
        lanes far0 = back0 + b1, far1 = back1 - b0, near0 = back0 + b0, near1 = back1 - b1;
        mask drop = either(either(lt(far0, zero), gt(r1, far0 * far0)),
                           either(lt(far1, zero), gt(r0, far1 * far1)));
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
        if (any(either(first, last)))
            trim(w, i, except(first, drop), except(last, drop), length, c0, c1);
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
        if (WITH_LINEAR)
            nearest =
                pick(linear_of(ids_load(w->source + i)), all(0) - greater(x * b0, x * b1), nearest);
        mask near = le(sigma + nearest, all(bound));
        kept = close_ranks(w, i, kept, both(first_lanes(count - i), near));
    }
    return kept;
}
