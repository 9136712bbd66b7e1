/* Part of kernel_lanes.h: writes windows as wedges. */
/* Returns true if there is a gap between two consecutive windows that is wider than the tolerance
 * for adjacent windows. */
static bool has_gaps(const struct gd__windows *w, uint32_t count, double length)
{
    const lanes tolerance = all(GD_TOL_ADJACENT * length);
    double before = 1e300;
    for (uint32_t i = 0; i < count; i += LANES) {
        lanes b1 = load(w->b1 + i);
        mask gap = gt(load(w->b0 + i), after(before, b1) + tolerance);
        if (any(both(first_lanes(count - i), gap))) return true;
        before = w->b1[i + LANES - 1];
    }
    return false;
}

/* The wedges to which windows are written. If the chunk begins with a gap, they are the wedges
 * after this gap. */
struct storing {
    struct gd__wedges to; /* the wedges without the first gap */
    double units;         /* number of units of wedge starts per unit of length */
    double scale;         /* factor by which x and y are multiplied before they are packed */
    uint64_t nibble;      /* mask of the bits of a source's number that x and y hold */
};

/* Writes a whole group to each array from index `at` on. Lanes outside `here` are also written,
 * behind the end of an array: to padding, or to the beginning of the next array, which is written
 * afterwards. */
static inline __attribute__((always_inline)) void
store_group(const struct storing *s, uint32_t at, lanes b0, lanes x, lanes y, ids source, mask here)
{
    lanes start = lesser(greater(b0 * all(s->units), all(0)), all(GD__WEDGE_LATEST));
    store_starts(s->to.start + at, pick(here, start, all(0)));
    store_highs(&s->to, at, ids_pick(here, source));
    store(s->to.x + at, packed(x * all(s->scale), source, GD__WEDGE_SHIFT, s->nibble));
    store(s->to.y + at, packed(y * all(s->scale), source, GD__WEDGE_SHIFT - 4, s->nibble));
}

static inline uint32_t last_group(uint32_t count)
{
    return (count - 1) & ~(uint32_t)(LANES - 1);
}

/* Writes the last group first. Its unused lanes overwrite the beginning of the next array. The
 * other groups then write this beginning again. */
static void store_straight(const struct gd__windows *w, uint32_t count, const struct storing *s)
{
    mask here = first_lanes(count - last_group(count));
    for (uint32_t i = last_group(count);; i -= LANES, here = mask_of(UINT32_MAX)) {
        store_group(s, i, load(w->b0 + i), load(w->x + i), all(-0.0) - load(w->y + i),
                    ids_load(w->source + i), here);
        if (!i) return;
    }
}

/* Writes the windows in reverse order. The group that contains the list's first windows begins
 * before the list. This memory belongs to the block's arrays or header, so it can be read. */
static void store_mirrored(const struct gd__windows *w, uint32_t count, double length,
                           const struct storing *s)
{
    const lanes whole = all(length);
    mask here = first_lanes(count - last_group(count));
    for (uint32_t i = last_group(count);; i -= LANES, here = mask_of(UINT32_MAX)) {
        ptrdiff_t at = (ptrdiff_t)count - i - LANES;
        store_group(s, i, reversed(whole - load(w->b1 + at)), reversed(whole - load(w->x + at)),
                    reversed(load(w->y + at)), ids_reversed(ids_load(w->source + at)), here);
        if (!i) return;
    }
}

static void store_gap(const struct gd__wedges *to, uint32_t at, double b, double units)
{
    double start = b * units;
    start = start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST;
    gd__wedge_put(to, at, (uint32_t)start, 0, 0, GD_NONE);
}

static bool store_wedges(const struct gd__windows *w, uint32_t count, double length, bool mirrored,
                         struct gd__chunk *out)
{
    /* linear windows are stored in another form, see window/wedges.c */
    if (WITH_LINEAR || has_gaps(w, count, length)) return false;
    bool before = w->b0[0] > GD_TOL_ADJACENT * length,
         behind = w->b1[count - 1] + GD_TOL_ADJACENT * length < length;
    bool first = mirrored ? behind : before, last = mirrored ? before : behind;
    out->is_far = mirrored;
    out->count = count + first + last;
    struct gd__wedges whole = gd__chunk_wedges(out);
    bool is_wide = whole.form == GD__WEDGE_WIDE;
    struct storing s = {.to = gd__wedges_from(&whole, first),
                        .units = GD__WEDGE_UNITS / length,
                        .scale = is_wide ? 1 : GD__WEDGE_SCALE,
                        .nibble = is_wide ? 0 : ~GD__WEDGE_MASK};
    memset((char *)whole.x - GD__CHUNK_UNIT, 0, GD__CHUNK_UNIT); /* the padding before x */
    if (mirrored)
        store_mirrored(w, count, length, &s);
    else
        store_straight(w, count, &s);
    whole.start[0] = 0; /* the first wedge starts exactly at the end of the edge */
    if (first) store_gap(&whole, 0, 0, s.units);
    if (last)
        store_gap(&whole, whole.count - 1, mirrored ? length - w->b0[0] : w->b1[count - 1],
                  s.units);
    return true;
}
