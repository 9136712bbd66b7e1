#include "window/wedges.h"

#include "gd/polygons.h"

/* Does the same as store_packed of the kernels. A source beyond the edge's line keeps y > 0. */
static void put_packed(const struct gd__wedges *wedges, uint32_t i, double x, double y,
                       uint32_t source)
{
    struct gd__wedge_zero zero = gd__wedge_zero(wedges->exponent);
    double least = source == GD_NONE ? 0 : gd__wedge_least(wedges->exponent);
    uint64_t x_bits = gd__wedge_bits(x + zero.x),
             y_bits = gd__wedge_bits((y > least ? y : least) + zero.y);
    wedges->word[i] = x_bits << GD__WEDGE_X_SHIFT |
                      (source & GD__WEDGE_LOW_MASK) << GD__WEDGE_Y_SHIFT | (y_bits & 3);
    wedges->high[i] = (uint32_t)(y_bits >> GD__WEDGE_HIGH_SHIFT);
    wedges->middle[i] = (uint16_t)(y_bits >> GD__WEDGE_Y_SHIFT);
    if (wedges->form == GD__WEDGE_20)
        ((uint8_t *)wedges->low)[i] = (uint8_t)(source >> GD__WEDGE_LOW_SHIFT);
    else
        ((uint16_t *)wedges->low)[i] = (uint16_t)(source >> GD__WEDGE_LOW_SHIFT);
}

void gd__wedge_put(const struct gd__wedges *wedges, uint32_t i, uint32_t start, double x, double y,
                   uint32_t source)
{
    wedges->start[i] = start;
    if (wedges->form != GD__WEDGE_WIDE) {
        put_packed(wedges, i, x, y, source);
        return;
    }
    wedges->x[i] = x;
    wedges->y[i] = y;
    wedges->high[i] = source;
}

struct gd__window gd__wedge_window(const struct gd__wedges *wedges, uint32_t i, double length)
{
    double unit = length * GD__WEDGE_UNIT;
    struct gd__window w = {.b0 = wedges->start[i] * unit,
                           .b1 = i + 1 < wedges->count ? wedges->start[i + 1] * unit : length,
                           .x = gd__wedge_x(wedges, i),
                           .y = gd__wedge_y(wedges, i),
                           .source = gd__wedge_source(wedges, i),
                           .tags = wedges->is_far ? GD__WINDOW_FAR_SIDE : 0};
    if (w.source == GD_NONE || !gd__window_is_linear(&w)) return w;
    double half = w.y, scale = 1 / (1 + half * half);
    w.sigma = w.x;
    w.x = (1 - half) * (1 + half) * scale;
    w.y = 2 * half * scale;
    return w;
}

/* Writes wedges to arrays, or only counts them. */
struct writer {
    const struct gd__wedges *to; /* NULL if wedges are only counted */
    uint32_t count;
    double length, units; /* units: number of units of wedge starts per unit of length */
    double end;           /* end of the last window */
    bool linear;          /* true if the last window was linear */
};

/* Rounds down to a whole number. Negative numbers come from rounding errors and become 0. */
static double round_down(double number)
{
    return number > 0 ? (double)(uint64_t)number : 0;
}

static double round_up(double number)
{
    double below = round_down(number);
    return below + (number > below);
}

static void writer_put(struct writer *writer, double b0, double x, double y, uint32_t source)
{
    if (writer->to) {
        double start = b0 * writer->units;
        if (source != GD_NONE && gd__source_is_linear(source)) start = round_up(start);
        start = start > 0 ? start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST : 0;
        gd__wedge_put(writer->to, writer->count, (uint32_t)start, x, y, source);
    }
    writer->count++;
}

/* Writes the gap from the last window to `until` if it is wider than rounding errors. Before or
 * after a linear window, every gap is written, because the ends of a linear window are rounded
 * inwards. Between two linear windows, a gap is written even if they meet exactly. */
static void writer_put_gap(struct writer *writer, double until, bool linear)
{
    bool both = linear && writer->linear;
    double narrow = linear || writer->linear ? 0 : GD_TOL_ADJACENT * writer->length;
    if (both || until > writer->end + narrow) writer_put(writer, writer->end, 0, 0, GD_NONE);
    writer->linear = linear;
}

/* Returns the tangent of half the angle of a unit vector, y > 0. */
static double half_tangent(double x, double y)
{
    return x > 0 ? y / (1 + x) : (1 - x) / y;
}

/* Returns true if a linear window is not empty when its ends have been rounded inwards. */
static bool window_has_inside(const struct writer *writer, const struct gd__window *w)
{
    return round_up(w->b0 * writer->units) < round_down(w->b1 * writer->units);
}

static void writer_put_all(struct writer *writer, const struct gd__windows *windows, uint32_t count,
                           bool mirrored)
{
    double length = writer->length;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__window w = gd__windows_get(windows, mirrored ? count - 1 - i : i);
        if (mirrored) w = gd__window_mirrored(&w, length);
        bool linear = gd__window_is_linear(&w);
        if (linear && !window_has_inside(writer, &w)) continue;
        double x = linear ? w.sigma : w.x, y = linear ? half_tangent(w.x, w.y) : w.y;
        writer_put_gap(writer, w.b0, linear);
        writer_put(writer, writer->count ? w.b0 : 0, x, y, w.source);
        writer->end = w.b1;
    }
    writer_put_gap(writer, length, false);
}

/* Chooses the form and the exponent. */
static void fit_chunk(const struct gd__windows *windows, uint32_t count, double length,
                      struct gd__chunk *out)
{
    double farthest = 0, nearest = INFINITY;
    bool is_linear = false;
    for (uint32_t i = 0; i < count; i++) {
        double x = fabs(windows->x[i]), y = windows->y[i];
        farthest = fmax(farthest, fmax(x, y));
        nearest = fmin(nearest, gd__wedge_nearest(x, y, windows->sigma[i], length));
        is_linear |= gd__source_is_linear(windows->source[i]);
    }
    int exponent = gd__wedge_exponent(farthest, length);
    if (is_linear || exponent < 0 || exponent >= 2 * GD__WEDGE_BIAS ||
        !gd__wedges_fit(farthest, nearest, length))
        out->form = GD__WEDGE_WIDE;
    out->exponent = out->form == GD__WEDGE_WIDE ? 0 : (uint32_t)exponent & 127;
}

void gd__chunk_write(const struct gd__windows *windows, uint32_t count, double length,
                     bool mirrored, struct gd__chunk *out)
{
    const double units = GD__WEDGE_UNITS / length;
    struct writer counter = {.length = length, .units = units};
    writer_put_all(&counter, windows, count, mirrored);
    fit_chunk(windows, count, length, out);
    out->is_far = mirrored;
    out->count = counter.count;
    struct gd__wedges to = gd__chunk_wedges(out);
    struct writer writer = {.to = &to, .length = length, .units = units};
    writer_put_all(&writer, windows, count, mirrored);
    gd__chunk_pad(out);
}
