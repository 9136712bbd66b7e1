#include "gd/curve.h"

#include <string.h>

static uint32_t curve_seeds_segments_of(const struct gd_curve *curve)
{
    return curve->closed && curve->count > 2 ? curve->count : curve->count - 1;
}

uint32_t gd_curve_seed_count(const struct gd_curve *curve)
{
    return curve->count + curve_seeds_segments_of(curve);
}

/* Padding is zeroed, so equal curves have equal bytes. */
void gd_curve_seeds(const struct gd_curve *curve, double offset, struct gd_seed *out)
{
    uint32_t count = gd_curve_seed_count(curve);
    memset(out, 0, count * sizeof *out);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = i / 2;
        out[i].point = curve->points[from];
        out[i].offset = offset;
        out[i].is_segment = i % 2;
        if (out[i].is_segment) out[i].end = curve->points[(from + 1) % curve->count];
    }
}
