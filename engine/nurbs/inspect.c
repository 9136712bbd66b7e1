#include <math.h>

#include "base/tolerance.h"
#include "gd/nurbs.h"

const char *gd_nurbs_flaw_name(enum gd_nurbs_flaw flaw)
{
    switch (flaw) {
#define FLAW_NAME(NAME, name)                                                                      \
    case GD_NURBS_FLAW_##NAME:                                                                     \
        return #name;
        GD_NURBS_FLAW_MAP(FLAW_NAME)
#undef FLAW_NAME
    }
    return "unknown";
}

/* Fills the detail. The value is the flaw, so the macro can be used in a return statement. */
#define refuse(flaw, detail, ...)                                                                  \
    (gd_fail(detail, GD_INVALID_ARGUMENT, __VA_ARGS__) == GD_OK ? GD_NURBS_FLAW_NONE : (flaw))

struct direction {
    char name;
    uint32_t degree, count, knot_count;
    const double *knots;
    bool short_knots; /* true if the convention omits the first and the last knot */
};

static enum gd_nurbs_flaw inspect_counts(const struct direction *d, struct gd_detail *detail)
{
    if (d->degree < 1 || d->degree > GD_NURBS_DEGREE_MAX)
        return refuse(GD_NURBS_FLAW_DEGREE, detail, "degree %u in %c is not between 1 and %d",
                      d->degree, d->name, GD_NURBS_DEGREE_MAX);
    if (d->count < d->degree + 1 || d->count > GD_NURBS_COUNT_MAX)
        return refuse(GD_NURBS_FLAW_CONTROL_COUNT, detail,
                      "%u control points in %c: degree %u needs at least %u, and %d are the most",
                      d->count, d->name, d->degree, d->degree + 1, GD_NURBS_COUNT_MAX);
    uint32_t needed = d->count + d->degree + 1 - (d->short_knots ? 2 : 0);
    if (d->knot_count != needed)
        return refuse(GD_NURBS_FLAW_KNOT_COUNT, detail,
                      "%u knots in %c: %u control points of degree %u need %u in this convention",
                      d->knot_count, d->name, d->count, d->degree, needed);
    return GD_NURBS_FLAW_NONE;
}

static enum gd_nurbs_flaw inspect_knots(const struct direction *d, struct gd_detail *detail)
{
    uint32_t skip = d->short_knots ? 1 : 0;
    const double *k = d->knots;
    for (uint32_t i = 0; i < d->knot_count; i++) {
        if (!isfinite(k[i]) || fabs(k[i]) > GD_EXTENT_MAX)
            return refuse(GD_NURBS_FLAW_NON_FINITE, detail,
                          "knot %u in %c is not a finite number of usable size", i, d->name);
        if (i && k[i] < k[i - 1])
            return refuse(GD_NURBS_FLAW_DECREASING_KNOTS, detail,
                          "knot %u in %c is %.17g, less than %.17g before it", i, d->name, k[i],
                          k[i - 1]);
    }
    double low = k[d->degree - skip], high = k[d->count - skip];
    if (!(low < high))
        return refuse(GD_NURBS_FLAW_EMPTY_DOMAIN, detail,
                      "the knots in %c leave no domain: it begins and ends at %.17g", d->name, low);
    for (uint32_t i = 0, first = 0; i < d->knot_count; i++) {
        if (k[i] > k[first]) first = i;
        bool inside = k[i] > low && k[i] < high;
        if (inside && i - first >= d->degree)
            return refuse(GD_NURBS_FLAW_KNOT_MULTIPLICITY, detail,
                          "knot %.17g in %c is repeated more than %u times: the surface would fall "
                          "apart there",
                          k[i], d->name, d->degree);
    }
    return GD_NURBS_FLAW_NONE;
}

static enum gd_nurbs_flaw inspect_points(const struct gd_nurbs_data *data, struct gd_detail *detail)
{
    for (uint32_t i = 0; i < data->count_u * data->count_v; i++) {
        uint32_t row = i / data->count_v, column = i % data->count_v;
        double weight = data->weights ? data->weights[i] : 1;
        if (!(weight > 0) || !isfinite(weight) || weight > GD_EXTENT_RATIO ||
            weight < 1 / GD_EXTENT_RATIO)
            return refuse(GD_NURBS_FLAW_WEIGHT, detail,
                          "the weight of control point (%u, %u) is %.17g: must be > 0", row, column,
                          weight);
        for (int c = 0; c < 3; c++) {
            if (!isfinite(data->points[i][c]))
                return refuse(GD_NURBS_FLAW_NON_FINITE, detail,
                              "control point (%u, %u) has a coordinate that is not a number", row,
                              column);
            if (fabs(data->points[i][c]) > GD_EXTENT_RATIO)
                return refuse(GD_NURBS_FLAW_EXTENT, detail,
                              "control point (%u, %u) lies too far out to compute with", row,
                              column);
        }
    }
    return GD_NURBS_FLAW_NONE;
}

enum gd_nurbs_flaw gd_nurbs_inspect(const struct gd_nurbs_data *data, struct gd_detail *detail)
{
    bool rhino = data->convention == GD_NURBS_RHINO;
    const struct direction directions[] = {
        {'u', data->degree_u, data->count_u, data->knot_count_u, data->knots_u, rhino},
        {'v', data->degree_v, data->count_v, data->knot_count_v, data->knots_v, rhino},
    };
    enum gd_nurbs_flaw flaw = GD_NURBS_FLAW_NONE;
    for (int i = 0; i < 2 && !flaw; i++) flaw = inspect_counts(&directions[i], detail);
    for (int i = 0; i < 2 && !flaw; i++) flaw = inspect_knots(&directions[i], detail);
    return flaw ? flaw : inspect_points(data, detail);
}
