/* Part of kernel_lanes.h: windows written as wedges. */
/* Starts of wedges, in units of 2^-32 of the edge; of those in `at_end` that is the edge's end,
 * whatever rounding made of it. */
static inline lanes starts_of(lanes b, double scale, mask at_end)
{
    return pick(at_end, all(0), lesser(greater(b * all(scale), all(0)), all(GD__WEDGE_LATEST)));
}

/* Whether a start lies behind the end of the window before it by more than what counts as
 * adjacent. */
static bool has_gaps(const struct gd__windows *w, uint32_t count, double length)
{
    const lanes tolerance = all(GD_TOL_ADJACENT * length);
    for (uint32_t i = 0; i + 1 < count; i += LANES) {
        mask gap = gt(load(w->b0 + i + 1), load(w->b1 + i) + tolerance);
        if (any(both(first_lanes(count - 1 - i), gap))) return true;
    }
    return false;
}

static void store_straight(const struct gd__windows *w, uint32_t count, double length, bool gap,
                           struct gd__wedges to)
{
    const double scale = GD__WEDGE_UNITS / length;
    for (uint32_t i = 0; i < count; i += LANES) {
        store_first(to.x + i, load(w->x + i), count - i);
        store_first(to.y + i, all(-0.0) - load(w->y + i), count - i);
        store_starts(to.start + i, starts_of(load(w->b0 + i), scale, mask_of(i == 0 && !gap)),
                     ids_load(w->source + i), count - i);
    }
}

/* From the last window to the first; groups begin before the list for the last of them, where a
 * block's own arrays or its header lie. */
static void store_mirrored(const struct gd__windows *w, uint32_t count, double length, bool gap,
                           struct gd__wedges to)
{
    const double scale = GD__WEDGE_UNITS / length;
    const lanes whole = all(length);
    for (uint32_t i = 0; i < count; i += LANES) {
        ptrdiff_t at = (ptrdiff_t)count - i - LANES;
        store_first(to.x + i, reversed(whole - load(w->x + at)), count - i);
        store_first(to.y + i, reversed(load(w->y + at)), count - i);
        store_starts(to.start + i,
                     starts_of(reversed(whole - load(w->b1 + at)), scale, mask_of(i == 0 && !gap)),
                     ids_reversed(ids_load(w->source + at)), count - i);
    }
}

static void store_gap(struct gd__wedges to, uint32_t at, double b, double length)
{
    double start = b * (GD__WEDGE_UNITS / length);
    to.x[at] = to.y[at] = 0;
    to.start[at] =
        (uint64_t)(start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST) | (uint64_t)GD_NONE << 32;
}

static uint32_t store_wedges(const struct gd__windows *w, uint32_t count, double length,
                             bool mirrored, double *data)
{
    /* linear: in another form, see wedges.c */
    if (WITH_LINEAR || has_gaps(w, count, length)) return 0;
    bool before = w->b0[0] > GD_TOL_ADJACENT * length,
         behind = w->b1[count - 1] + GD_TOL_ADJACENT * length < length;
    bool first = mirrored ? behind : before, last = mirrored ? before : behind;
    uint32_t total = count + first + last;
    struct gd__wedges whole = gd__wedges_at(data, total),
                      to = {whole.x + first, whole.y + first, whole.start + first};
    if (mirrored)
        store_mirrored(w, count, length, first, to);
    else
        store_straight(w, count, length, first, to);
    if (first) store_gap(whole, 0, 0, length);
    if (last) store_gap(whole, total - 1, mirrored ? length - w->b0[0] : w->b1[count - 1], length);
    return total;
}
