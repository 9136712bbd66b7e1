#include "window/wedges.h"

#include "gd/polygons.h"

struct gd__window gd__wedge_window(struct gd__wedges wedges, uint32_t count, uint32_t i,
                                   double length)
{
    double unit = length * GD__WEDGE_UNIT, y = wedges.y[i];
    struct gd__window w = {.b0 = gd__wedge_start(wedges.start[i]) * unit,
                           .b1 =
                               i + 1 < count ? gd__wedge_start(wedges.start[i + 1]) * unit : length,
                           .x = wedges.x[i],
                           .y = fabs(y),
                           .source = gd__wedge_source(wedges.start[i]),
                           .tags = signbit(y) ? 0 : GD__WINDOW_FAR_SIDE};
    if (w.source == GD_NONE || !gd__window_is_linear(&w)) return w;
    double half = w.y, scale = 1 / (1 + half * half);
    w.sigma = w.x;
    w.x = (1 - half) * (1 + half) * scale;
    w.y = 2 * half * scale;
    return w;
}

/* Where wedges go; without arrays they are counted only. */
struct writer {
    struct gd__wedges to; /* x is NULL: count */
    uint32_t count;
    double length, units; /* of starts, in a unit of length */
    double end;           /* where the last window ended */
    bool linear;          /* it was one such */
};

/* To whole numbers, of numbers that are not negative but by rounding. */
static double down(double number)
{
    return number > 0 ? (double)(uint64_t)number : 0;
}

static double up(double number)
{
    double below = down(number);
    return below + (number > below);
}

static void put(struct writer *writer, double b0, double x, double y, uint32_t source)
{
    if (writer->to.x) {
        double start = b0 * writer->units;
        if (source != GD_NONE && gd__source_is_linear(source)) start = up(start);
        start = start > 0 ? start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST : 0;
        writer->to.x[writer->count] = x;
        writer->to.y[writer->count] = y;
        writer->to.start[writer->count] = (uint64_t)start | (uint64_t)source << 32;
    }
    writer->count++;
}

/* A window reaches over what is hardly a gap, but not a linear one: between two such there is the
 * unit in which they meet. */
static void put_gap(struct writer *writer, double until, bool linear)
{
    bool both = linear && writer->linear;
    double narrow = linear || writer->linear ? 0 : GD_TOL_ADJACENT * writer->length;
    if (both || until > writer->end + narrow) put(writer, writer->end, 0, 0, GD_NONE);
    writer->linear = linear;
}

/* Tangent of half the angle of a unit vector, y > 0. */
static double half_tangent(double x, double y)
{
    return x > 0 ? y / (1 + x) : (1 - x) / y;
}

/* Whether anything is left of a linear window when its ends are rounded inwards. */
static bool has_inside(const struct writer *writer, const struct gd__window *w)
{
    return up(w->b0 * writer->units) < down(w->b1 * writer->units);
}

static void put_all(struct writer *writer, const struct gd__windows *windows, uint32_t count,
                    bool mirrored)
{
    double length = writer->length;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__window w = gd__windows_get(windows, mirrored ? count - 1 - i : i);
        if (mirrored) w = gd__window_mirrored(&w, length);
        bool linear = gd__window_is_linear(&w);
        if (linear && !has_inside(writer, &w)) continue;
        double x = linear ? w.sigma : w.x, y = linear ? half_tangent(w.x, w.y) : w.y;
        put_gap(writer, w.b0, linear);
        put(writer, writer->count ? w.b0 : 0, x, mirrored ? y : -y, w.source);
        writer->end = w.b1;
    }
    put_gap(writer, length, false);
}

uint32_t gd__wedges_write(const struct gd__windows *windows, uint32_t count, double length,
                          bool mirrored, double *data)
{
    const double units = GD__WEDGE_UNITS / length;
    struct writer counter = {.length = length, .units = units};
    put_all(&counter, windows, count, mirrored);
    uint32_t total = counter.count;
    struct writer writer = {.to = gd__wedges_at(data, total), .length = length, .units = units};
    put_all(&writer, windows, count, mirrored);
    return total;
}
