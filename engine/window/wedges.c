#include "window/wedges.h"

#include "gd/polygons.h"

static double wedge_pack(const struct gd__wedges *wedges, double coordinate, uint32_t bits)
{
    if (wedges->form == GD__WEDGE_WIDE) return coordinate;
    double scaled = coordinate * GD__WEDGE_SCALE;
    uint64_t packed = gd__wedge_bits(&scaled) | (uint64_t)(bits & GD__WEDGE_NIBBLE)
                                                    << GD__WEDGE_SHIFT;
    memcpy(&scaled, &packed, sizeof scaled);
    return scaled;
}

void gd__wedge_put(const struct gd__wedges *wedges, uint32_t i, uint32_t start, double x, double y,
                   uint32_t source)
{
    wedges->start[i] = start;
    wedges->x[i] = wedge_pack(wedges, x, source);
    wedges->y[i] = wedge_pack(wedges, y, source >> 4);
    switch (wedges->form) {
    case GD__WEDGE_16:
        ((uint8_t *)wedges->high)[i] = (uint8_t)(source >> 8);
        break;
    case GD__WEDGE_24:
        ((uint16_t *)wedges->high)[i] = (uint16_t)(source >> 8);
        break;
    case GD__WEDGE_WIDE:
        ((uint32_t *)wedges->high)[i] = source;
        break;
    }
}

struct gd__window gd__wedge_window(const struct gd__wedges *wedges, uint32_t i, double length)
{
    double unit = length * GD__WEDGE_UNIT, y = gd__wedge_unpack(wedges, &wedges->y[i]);
    struct gd__window w = {.b0 = wedges->start[i] * unit,
                           .b1 = i + 1 < wedges->count ? wedges->start[i + 1] * unit : length,
                           .x = gd__wedge_unpack(wedges, &wedges->x[i]),
                           .y = fabs(y),
                           .source = gd__wedge_source(wedges, i),
                           .tags = signbit(y) ? 0 : GD__WINDOW_FAR_SIDE};
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

/* Returns true if a linear window is not empty after its ends are rounded inwards. */
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
        writer_put(writer, writer->count ? w.b0 : 0, x, mirrored ? y : -y, w.source);
        writer->end = w.b1;
    }
    writer_put_gap(writer, length, false);
}

static bool needs_wide_form(const struct gd__windows *windows, uint32_t count, double length)
{
    bool is_wide = false;
    for (uint32_t i = 0; i < count; i++)
        is_wide |= gd__source_is_linear(windows->source[i]) ||
                   !(fabs(windows->x[i]) + length < GD__WEDGE_LIMIT) ||
                   !(windows->y[i] < GD__WEDGE_LIMIT);
    return is_wide;
}

void gd__chunk_write(const struct gd__windows *windows, uint32_t count, double length,
                     bool mirrored, struct gd__chunk *out)
{
    const double units = GD__WEDGE_UNITS / length;
    struct writer counter = {.length = length, .units = units};
    writer_put_all(&counter, windows, count, mirrored);
    if (needs_wide_form(windows, count, length)) out->form = GD__WEDGE_WIDE;
    out->is_far = mirrored;
    out->count = counter.count;
    struct gd__wedges to = gd__chunk_wedges(out);
    /* this also zeroes the padding */
    memset(out->data, 0, gd__wedge_heads_bytes(out->count, out->form));
    struct writer writer = {.to = &to, .length = length, .units = units};
    writer_put_all(&writer, windows, count, mirrored);
}
