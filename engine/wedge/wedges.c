#include "wedge/wedges.h"

#include "gd/polygons.h"

struct gd__window gd__wedge_window(struct gd__wedges wedges, uint32_t count, uint32_t i, double length)
{
    double unit = length * GD__WEDGE_UNIT, y = wedges.y[i];
    return (struct gd__window){.b0 = gd__wedge_start(wedges.start[i]) * unit,
                               .b1 = i + 1 < count ? gd__wedge_start(wedges.start[i + 1]) * unit : length,
                               .x = wedges.x[i],
                               .y = fabs(y),
                               .source = gd__wedge_source(wedges.start[i]),
                               .tags = signbit(y) ? 0 : GD__WINDOW_FAR_SIDE};
}

/* Where wedges go; without arrays they are counted only. */
struct writer {
    struct gd__wedges to; /* x is NULL: count */
    uint32_t count;
    double length, end; /* where the last window ended */
};

static void put(struct writer *writer, double b0, double x, double y, uint32_t source)
{
    if (writer->to.x) {
        double start = b0 / writer->length * GD__WEDGE_UNITS;
        start = start > 0 ? start < GD__WEDGE_LATEST ? start : GD__WEDGE_LATEST : 0;
        writer->to.x[writer->count] = x;
        writer->to.y[writer->count] = y;
        writer->to.start[writer->count] = (uint64_t)start | (uint64_t)source << 32;
    }
    writer->count++;
}

static void put_gap(struct writer *writer, double until)
{
    if (until > writer->end + GD_TOL_ADJACENT * writer->length) put(writer, writer->end, 0, 0, GD_NONE);
}

static void put_all(struct writer *writer, const struct gd__windows *w, uint32_t count, bool mirrored)
{
    double length = writer->length;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = mirrored ? count - 1 - i : i;
        double b0 = mirrored ? length - w->b1[at] : w->b0[at], b1 = mirrored ? length - w->b0[at] : w->b1[at];
        put_gap(writer, b0);
        put(writer, writer->count ? b0 : 0, mirrored ? length - w->x[at] : w->x[at], mirrored ? w->y[at] : -w->y[at],
            w->source[at]);
        writer->end = b1;
    }
    put_gap(writer, length);
}

uint32_t gd__wedges_write(const struct gd__windows *windows, uint32_t count, double length, bool mirrored, double *data)
{
    struct writer counter = {.length = length};
    put_all(&counter, windows, count, mirrored);
    uint32_t total = counter.count;
    struct writer writer = {.to = {data, data + total, (uint64_t *)(data + 2 * (size_t)total)}, .length = length};
    put_all(&writer, windows, count, mirrored);
    return total;
}
