/* Loops: the closed curves that bound a trimmed domain in the parameter plane.
 *
 * DESIGN
 * - Each loop is a chain of rational Bézier spans. Place s of a loop is at parameter s - i of span
 *   i = floor(s). s is periodic.
 * - The domain is on the left of each loop: the outer loop runs counter-clockwise, holes run
 *   clockwise.
 * - Distances in the plane are scaled: both directions of the domain have the width 1.
 * - `samples` is a polyline along all loops, closer than GD__LOOPS_SAG to them. */
#pragma once

#include <stdatomic.h>
#include <stddef.h>

#include "base/pace.h"
#include "gd/trim.h"

/* Largest scaled distance of the sampled polyline from the loops. */
#define GD__LOOPS_SAG 1e-4

#define GD__SPAN_DEGREE_MAX 15

/* A rational Bézier curve in the parameter plane, the smooth part of a trimming loop. */
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

struct gd__loop {
    uint32_t first_span, span_count;
};

/* A polyline along all loops: loop i has the places first[i] to first[i + 1] - 1. Each place is
 * joined to the next one, and the last to the first. */
struct gd__loop_samples {
    uint32_t count, capacity;
    double (*at)[2];
    uint32_t s_capacity;
    double *s;
    uint32_t *first; /* count of loops + 1 */
};

struct gd__loops {
    double low[2], width[2]; /* lower corner and widths of the rectangle */
    bool has_outer;
    uint32_t count, span_count;
    struct gd__loop *loops;
    struct gd__span *spans;
    double (*points)[3];
    struct gd__loop_samples samples;
    size_t bytes;
};

/* A place of a loop. */
struct gd__loop_place {
    uint32_t loop;
    double s;
    double at[2];
    double distance; /* scaled, from the given place */
    bool is_corner;  /* s is the end of a span, with the tolerance GD_TOL_LOOP_PLACE */
};

/* Creates the loops of a domain. Errors and fault are those of gd_parametric_trim. */
GD_MUST_USE enum gd_status gd__loops_create(const double low[2], const double high[2],
                                            const struct gd_trims *trims, struct gd__pace *pace,
                                            struct gd__loops **out, struct gd_trim_fault *fault);

void gd__loops_free(struct gd__loops *loops); /* NULL is allowed */

/* Writes the fault with its sentence to `fault`, unless it is NULL. Returns GD_INVALID_ARGUMENT. */
enum gd_status gd__loops_fail(struct gd_trim_fault *fault, uint32_t loop, uint32_t curve,
                              const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Checks that loops do not cross or touch, and that they are nested properly. Reverses loops such
 * that the domain is on their left. */
GD_MUST_USE enum gd_status gd__loops_check(struct gd__loops *loops, struct gd__pace *pace,
                                           struct gd_trim_fault *fault);

/* Samples all loops. The scaled distance of neighbouring samples is at most `longest`. Errors:
 * GD_NO_MEMORY, GD_TOO_LARGE (too many samples), GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__loops_sample(const struct gd__loops *loops, double longest,
                                            struct gd__pace *pace, struct gd__loop_samples *out);
void gd__loop_samples_free(struct gd__loop_samples *samples);

/* Evaluates a loop at s, which is taken modulo the number of spans. At the end of a span, `before`
 * selects the derivatives of the span that ends there. */
void gd__loop_jet(const struct gd__loops *loops, uint32_t loop, double s, bool before,
                  struct gd__span_jet *out);

/* Returns the caller's curve that holds the place s. */
uint32_t gd__loop_curve(const struct gd__loops *loops, uint32_t loop, double s);

/* Finds the place of a loop nearest to `at`. Returns the scaled distance with a sign: positive
 * inside the domain, negative outside. O(samples). */
double gd__loops_depth(const struct gd__loops *loops, const double at[2],
                       struct gd__loop_place *out);

/* Returns true if the place is inside loop `i` or on it. Counts the crossings of a ray with the
 * loop. */
bool gd__loop_surrounds(const struct gd__loops *loops, uint32_t i, const double at[2]);
