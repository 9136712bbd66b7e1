/* Spans: intervals of the angle around a point, and their complement in the full circle. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"

enum { GD__TURN_PARTS = 6 };

/* An interval from..to, counter-clockwise. The caller identifies each of its two borders by a
 * number. */
struct gd__span {
    double from, to;
    uint32_t from_by, to_by;
};

/* A union of a few disjoint spans within [-pi, pi]. */
struct gd__turn {
    int count;
    struct gd__span part[GD__TURN_PARTS];
};

static const struct gd__turn gd__turn_all = {1, {{.from = -M_PI, .to = M_PI}}};

/* Returns the angles where cos(angle - phi) >= q, for phi in [-pi, pi]. */
struct gd__turn gd__turn_around(double phi, double q);

/* Returns the intersection. m and n spans give at most m + n - 1. */
struct gd__turn gd__turn_both(const struct gd__turn *a, const struct gd__turn *b);

/* Replaces the spans of `turn` by their intersection with those of `other`. Usually both have one
 * span. */
static inline void gd__turn_narrow(struct gd__turn *turn, const struct gd__turn *other)
{
    if (turn->count != 1 || other->count != 1) {
        *turn = gd__turn_both(turn, other);
        return;
    }
    struct gd__span *span = &turn->part[0];
    *span = (struct gd__span){.from = fmax(span->from, other->part[0].from),
                              .to = fmin(span->to, other->part[0].to)};
    turn->count = span->from < span->to;
}

/* A reused list of spans; an all-zero struct is empty. `status` is GD_NO_MEMORY if the list lacks
 * spans because memory is short. It stays so, and lists that are computed from this list get it. */
struct gd__spans {
    struct gd__span *span;
    uint32_t count, capacity;
    enum gd_status status;
};

/* Appends the spans of `turn`. Each of their borders gets the number `by`. */
void gd__spans_put(struct gd__spans *spans, const struct gd__turn *turn, uint32_t by);

enum { GD__SPANS_FEW = 64 };

/* Joins the spans that overlap, and sets `*limit` to the number of spans at which this is worth its
 * time again. Returns true if there is no gap wider than `least` in [-pi, pi]. O(n log n). */
bool gd__spans_unite(struct gd__spans *covered, double least, uint32_t *limit);

/* Call this function after puts. `*limit` is GD__SPANS_FEW at first. A list then stays about as
 * short as its union, even if thousands of spans are put. Returns true if further spans change no
 * complement. */
static inline bool gd__spans_settle(struct gd__spans *covered, double least, uint32_t *limit)
{
    return covered->count > *limit && gd__spans_unite(covered, least, limit);
}

/* Computes the complement of `covered` in [-pi, pi], without spans of width `least` or less. A
 * border gets the number of the adjacent covered span's border, or GD__SPAN_OPEN at +-pi. Sorts
 * `covered`. O(n log n). */
#define GD__SPAN_OPEN UINT32_MAX
void gd__spans_invert(struct gd__spans *covered, double least, struct gd__spans *out);

/* Sets `covered` to the complement of `turn`. `scratch` is overwritten. */
void gd__spans_cover_outside(const struct gd__turn *turn, struct gd__spans *covered,
                             struct gd__spans *scratch);

/* Joins the first and the last span if they meet at +-pi. The joined span extends beyond pi. */
void gd__spans_join(struct gd__spans *spans);
