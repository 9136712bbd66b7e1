/* Part of kernel_lanes.h: casts windows across a face. */
/* Offers the apex the lengths of straight paths, one by one. There are few such paths, so a square
 * root of all lanes would take longer. */
static inline void reach_straight(struct gd__apex *apex, const struct gd__windows *w, uint32_t i,
                                  mask offers, double px, double py)
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

/* Scales a direction to length 1, because rounding errors change its length across many narrow
 * faces. */
static inline void keep_unit(mask linear, lanes *x, lanes *y)
{
    lanes scale = pick(linear, all(1) / root(*x * *x + *y * *y), all(1));
    *x = *x * scale;
    *y = *y * scale;
}

/* Computes a / b and c / d with only one division, because a division is the most expensive
 * operation. */
static inline void quotients(lanes a, lanes b, lanes c, lanes d, lanes *first, lanes *second)
{
    lanes inverse = all(1) / (b * d);
    *first = a * (d * inverse);
    *second = c * (b * inverse);
}

/* A group of windows, with e = b - x and k(b) (kernel_lanes.h) for the ray through each end b. The
 * sign of k tells on which side of the apex the ray passes. */
struct rays {
    lanes b0, b1, x, y, sigma, e0, e1, k0, k1;
    /* only for linear windows: distance at the apex minus distance at the frame's origin */
    lanes beyond;
    ids source;
    mask active, linear;
};

/* Functions are inlined so that groups stay in registers. */
#define INLINE static inline __attribute__((always_inline))

INLINE struct rays load_rays(const struct gd__windows *w, uint32_t i, uint32_t count, lanes px,
                             lanes py)
{
    struct rays r;
    r.active = first_lanes(count - i);
    r.b0 = load(w->b0 + i);
    r.b1 = load(w->b1 + i);
    r.x = load(w->x + i);
    r.y = load(w->y + i);
    r.sigma = load(w->sigma + i);
    r.source = ids_load(w->source + i);
    r.linear = linear_of(r.source);
    r.e0 = r.b0 - r.x;
    r.e1 = r.b1 - r.x;
    lanes hy = py + r.y, turn = r.y * (px - r.x);
    r.k0 = r.e0 * hy - turn;
    r.k1 = r.e1 * hy - turn;
    r.beyond = all(0);
    if (WITH_LINEAR) {
        r.beyond = r.y * py - r.x * px;
        r.k0 = pick(r.linear, r.y * (r.b0 - px) - r.x * py, r.k0);
        r.k1 = pick(r.linear, r.y * (r.b1 - px) - r.x * py, r.k1);
        r.e0 = pick(r.linear, all(0) - r.x, r.e0);
        r.e1 = pick(r.linear, all(0) - r.x, r.e1);
    }
    return r;
}

/* Casts the windows in the mask `may` onto the edge from the origin to the apex. */
INLINE void cast_left(const struct gd_side *side, const struct rays *r, mask may,
                      struct chain *chain, bool more, bool coalesce)
{
    const double length = side->left_length;
    const lanes zero = all(0), one = all(1), whole = all(length), ux = all(side->left_x),
                uy = all(side->left_y);
    lanes y = uy * r->x + ux * r->y, x = r->x * ux - r->y * uy, back = r->y * ux,
          minus_y = zero - r->y, t0, t1;
    if (WITH_LINEAR) keep_unit(r->linear, &x, &y);
    mask from_origin = le(r->b0, zero), to_apex = ge(r->k1, zero);
    quotients(r->b0 * minus_y, pick(from_origin, one, r->e0 * uy - back), r->b1 * minus_y,
              pick(to_apex, one, r->e1 * uy - back), &t0, &t1);
    t0 = pick(except(ge(t0, zero), from_origin), t0, zero);
    t1 = pick(except(le(t1, whole), to_apex), t1, whole);
    append(chain, more, coalesce, wide_enough(may, t0, t1, x, y, length, r->linear), t0, t1, x, y,
           r->sigma, r->source);
}

/* Casts the windows in the mask `may` onto the edge from the apex to the destination. */
INLINE void cast_right(const struct gd_side *side, const struct rays *r, mask may, lanes px,
                       lanes py, struct chain *chain, bool more, bool coalesce)
{
    const double length = side->right_length;
    const lanes zero = all(0), one = all(1), whole = all(length), vx = all(side->right_x),
                vy = all(side->right_y);
    lanes dx = r->x - px, dy = zero - r->y - py, sigma = r->sigma, t0, t1;
    if (WITH_LINEAR) {
        dx = pick(r->linear, r->x, dx);
        dy = pick(r->linear, zero - r->y, dy);
        sigma = pick(r->linear, sigma + r->beyond, sigma);
    }
    lanes y = vy * dx - vx * dy, x = dx * vx + dy * vy, back = r->y * vx;
    if (WITH_LINEAR) keep_unit(r->linear, &x, &y);
    mask from_apex = le(r->k0, zero), to_end = ge(r->b1, all(side->length));
    quotients(zero - r->k0, pick(from_apex, one, r->e0 * vy - back), zero - r->k1,
              pick(to_end, one, r->e1 * vy - back), &t0, &t1);
    t0 = pick(except(ge(t0, zero), from_apex), t0, zero);
    t1 = pick(except(le(t1, whole), to_end), t1, whole);
    append(chain, more, coalesce, wide_enough(may, t0, t1, x, y, length, r->linear), t0, t1, x, y,
           sigma, r->source);
}

static void cast(const struct gd_side *side, const struct gd__windows *w, uint32_t count,
                 bool coalesce, struct gd__apex *apex, struct gd__children *left_list,
                 struct gd__children *right_list)
{
    const double apex_x = side->left_length * side->left_x,
                 apex_y = side->left_length * side->left_y;
    const lanes zero = all(0), px = all(apex_x), py = all(apex_y);
    struct chain left = open_chain(left_list, GD_TOL_WIDTH * side->left_length),
                 right = open_chain(right_list, GD_TOL_WIDTH * side->right_length);
    uint32_t last_left = GD_NONE, first_right = GD_NONE;
    for (uint32_t i = 0; i < count; i += LANES) {
        const bool more = i + LANES < count;
        struct rays r = load_rays(w, i, count, px, py);
        mask passes_left = both(r.active, lt(r.k1, zero)),
             passes_right = both(r.active, gt(r.k0, zero)),
             straight = except(r.active, either(passes_left, passes_right));
        if (any(straight)) reach_straight(apex, w, i, straight, apex_x, apex_y);
        last_left = any(passes_left) ? i + last_set(passes_left) : last_left;
        first_right =
            any(passes_right) && first_right == GD_NONE ? i + first_set(passes_right) : first_right;
        mask to_left = both(r.active, lt(r.k0, zero)), to_right = both(r.active, gt(r.k1, zero));
        if (any(to_left)) cast_left(side, &r, to_left, &left, more, coalesce);
        if (any(to_right)) cast_right(side, &r, to_right, px, py, &right, more, coalesce);
    }
    apex->last_left = last_left;
    apex->first_right = first_right;
}
