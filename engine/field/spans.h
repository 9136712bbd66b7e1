/* Spans: intervals of the angle about a point, and what they leave of the full turn. */
#ifndef GD_FIELD_SPANS_H
#define GD_FIELD_SPANS_H

#include <math.h>
#include <stdint.h>

#include "gd/status.h"

enum { GD__TURN_PARTS = 6 };

/* From..to, counter-clockwise; who bounds it there, in the caller's numbers. */
struct gd__span {
    double from, to;
    uint32_t from_by, to_by;
};

/* Part of the turn: few disjoint spans within [-pi, pi]. */
struct gd__turn {
    int count;
    struct gd__span part[GD__TURN_PARTS];
};

static const struct gd__turn gd__turn_all = {1, {{.from = -M_PI, .to = M_PI}}};

/* Where cos(angle - phi) >= q; phi in [-pi, pi]. */
struct gd__turn gd__turn_around(double phi, double q);

/* What two have in common: of m and n spans at most m + n - 1. */
struct gd__turn gd__turn_both(const struct gd__turn *a, const struct gd__turn *b);

/* All zero is empty; reused. */
struct gd__spans {
    struct gd__span *span;
    uint32_t count, capacity;
};

/* Appends the parts of a turn, as put there by `by`. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__spans_put(struct gd__spans *spans, const struct gd__turn *turn,
                                         uint32_t by);

/* What the spans leave of [-pi, pi], without what is no wider than `least`: bounded by who put the
 * spans on either side, GD__SPAN_OPEN where there is none. Sorts `covered`. GD_NO_MEMORY. O(n^2) at
 * worst. */
#define GD__SPAN_OPEN UINT32_MAX
GD_MUST_USE enum gd_status gd__spans_invert(struct gd__spans *covered, double least,
                                            struct gd__spans *out);

/* Makes a first and a last span that meet at pi one, which then reaches beyond pi. */
void gd__spans_join(struct gd__spans *spans);

#endif
