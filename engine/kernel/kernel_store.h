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

/* Returns the exponent of a chunk. Changes its form to WIDE if packing would change a distance by
 * more than 1e-14 of it (gd__wedges_fit). */
static inline uint32_t fitted_exponent(const struct gd__windows *w, uint32_t count, double length,
                                       enum gd__wedge_form *form)
{
    lanes farthest = all(0), nearest = all(INFINITY), whole = all(length);
    for (uint32_t i = 0; i < count; i += LANES) {
        mask here = first_lanes(count - i);
        lanes x = magnitude(load(w->x + i)), y = load(w->y + i),
              near = load(w->sigma + i) + greater(x - whole, y);
        farthest = greater(farthest, pick(here, greater(x, y), all(0)));
        nearest = lesser(nearest, pick(here, near, all(INFINITY)));
    }
    double most = most_of(farthest);
    int exponent = gd__wedge_exponent(most, length);
    if (exponent < 0 || exponent >= 2 * GD__WEDGE_BIAS ||
        any(le(nearest * all(GD__WEDGE_DETOUR), all(most + length))))
        *form = GD__WEDGE_WIDE;
    return *form == GD__WEDGE_WIDE ? 0 : (uint32_t)exponent;
}

struct storing {
    struct gd__wedges to;
    uint32_t first; /* 1 if the chunk begins with a gap */
    double units;   /* number of units of wedge starts per unit of length */
    struct gd__wedge_zero zero;
    double least;
};

/* Writes a whole group to each array, beginning with the wedge of window `at`. Lanes behind the end
 * of an array go to the beginning of the next array, which is written afterwards, or behind the
 * chunk. */
static inline __attribute__((always_inline)) void
store_group(const struct storing *s, uint32_t at, lanes b0, lanes x, lanes y, ids source)
{
    lanes start = lesser(greater(b0 * all(s->units), all(0)), all(GD__WEDGE_LATEST));
    at += s->first;
    if (s->to.form == GD__WEDGE_WIDE) {
        store_doubles(s->to.x + at, x);
        store_doubles(s->to.y + at, y);
        store_starts(s->to.start + at, start);
        ids_store(s->to.high + at, source);
        return;
    }
    struct packed p =
        packed(x + all(s->zero.x), greater(y, all(s->least)) + all(s->zero.y), source);
    store_words(s->to.word + at, p.word);
    store_starts(s->to.start + at, start);
    store_rest(&s->to, at, &p);
}

static inline uint32_t last_group(uint32_t count)
{
    return (count - 1) & ~(uint32_t)(LANES - 1);
}

/* Writes the last group first. Its unused lanes overwrite the beginning of the next array. The
 * other groups then write this beginning again. */
static void store_straight(const struct gd__windows *w, uint32_t count, const struct storing *s)
{
    for (uint32_t i = last_group(count);; i -= LANES) {
        store_group(s, i, load(w->b0 + i), load(w->x + i), load(w->y + i), ids_load(w->source + i));
        if (!i) return;
    }
}

/* Writes the windows in reverse order. The group that contains the list's first windows begins
 * before the list. This memory belongs to the block's arrays or header, so it can be read. */
static void store_mirrored(const struct gd__windows *w, uint32_t count, double length,
                           const struct storing *s)
{
    const lanes whole = all(length);
    for (uint32_t i = last_group(count);; i -= LANES) {
        ptrdiff_t at = (ptrdiff_t)count - i - LANES;
        store_group(s, i, reversed(whole - load(w->b1 + at)), reversed(whole - load(w->x + at)),
                    reversed(load(w->y + at)), ids_reversed(ids_load(w->source + at)));
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
    /* The header is written last, from values in registers, because a read after narrower writes
       waits until these are in the cache. */
    enum gd__wedge_form form = out->form;
    uint32_t exponent = fitted_exponent(w, count, length, &form), stored = count + first + last;
    struct storing s = {.to = gd__wedges_of(out->data, stored, form, exponent, mirrored),
                        .first = first,
                        .units = GD__WEDGE_UNITS / length,
                        .zero = gd__wedge_zero((int)exponent - GD__WEDGE_BIAS),
                        .least = gd__wedge_least((int)exponent - GD__WEDGE_BIAS)};
    if (mirrored)
        store_mirrored(w, count, length, &s);
    else
        store_straight(w, count, &s);
    s.to.start[0] = 0; /* the first wedge starts exactly at the end of the edge */
    if (first) store_gap(&s.to, 0, 0, s.units);
    if (last)
        store_gap(&s.to, count + first, mirrored ? length - w->b0[0] : w->b1[count - 1], s.units);
    *out = (struct gd__chunk){
        .count = stored, .exponent = exponent & 127, .is_far = mirrored, .form = form};
    gd__chunk_pad(out);
    return true;
}
