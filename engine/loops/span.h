/* Span: a rational Bézier curve in the parameter plane, the smooth part of a trimming loop. */
#ifndef GD_LOOPS_SPAN_H
#define GD_LOOPS_SPAN_H

#include <stdbool.h>
#include <stdint.h>

#define GD__SPAN_DEGREE_MAX 15

struct gd__span {
    uint32_t degree, curve; /* curve: number of the curve in the caller's loop */
    bool is_straight;       /* degree 1 */
    double (*points)[3];    /* degree + 1 points (w u, w v, w); borrowed from the loops */
};

/* A place of a span, and its first and second derivative with respect to the parameter. */
struct gd__span_jet {
    double at[2], first[2], second[2];
};

/* Evaluates a span at t in [0, 1]. O(degree^2). */
void gd__span_jet(const struct gd__span *span, double t, struct gd__span_jet *out);

#endif
