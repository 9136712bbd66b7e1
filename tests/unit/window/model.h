/* Makes random windows, and the model with which lists are compared. The model has, at each
 * parameter, the minimum over all offered windows. */
#pragma once

#include "tests/support/test.h"

#include <math.h>

#include "window/list.h"

#define WIDTH 1e-10 /* lists may drop windows up to this width */

/* Returns a random window on an edge of length 1. */
static inline struct gd__window random_window(struct rng *rng, uint32_t source)
{
    double a = rng_unit(rng), b = rng_unit(rng);
    return (struct gd__window){.b0 = fmin(a, b),
                               .b1 = fmax(a, b),
                               .x = rng_between(rng, -1, 2),
                               .y = rng_between(rng, 0.01, 1.5),
                               .sigma = rng_between(rng, 0, 0.5),
                               .source = source};
}

static inline void append_window(struct gd__stack *stack, struct gd__window window)
{
    check_ok(gd__stack_reserve(stack, stack->count + 1), NULL);
    stack->windows[stack->count++] = window;
}

/* Returns the minimum over the windows at t; INFINITY where there is none. */
static inline double least_distance(const struct gd__stack *windows, double t)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < windows->count; i++)
        if (windows->windows[i].b0 <= t && t <= windows->windows[i].b1)
            least = fmin(least, gd__window_distance(&windows->windows[i], t));
    return least;
}

static inline void check_sorted_and_disjoint(const struct gd__stack *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        assert_true(list->windows[i].b1 - list->windows[i].b0 > WIDTH);
        if (i) assert_true(list->windows[i].b0 >= list->windows[i - 1].b1 - WIDTH);
    }
}

/* Checks that the list is sorted, disjoint, and everywhere as short as the best offered window. */
static inline void check_envelope(const struct gd__stack *list, const struct gd__stack *offered)
{
    check_sorted_and_disjoint(list);
    for (int k = 1; k < 200; k++) {
        /* not a multiple of 1/200, because windows may end at such multiples */
        double t = k / 200.0 + 1e-4;
        check_close(least_distance(list, t), least_distance(offered, t), 1e-12);
    }
}

/* Checks that each window is a piece of the offered window whose index is its source. */
static inline void check_pieces(const struct gd__stack *list, const struct gd__stack *offered)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const struct gd__window *piece = &list->windows[i];
        assert_true(piece->source < offered->count);
        const struct gd__window *whole = &offered->windows[piece->source];
        assert_true(piece->x == whole->x && piece->y == whole->y && piece->sigma == whole->sigma);
        assert_true(piece->b0 >= whole->b0 - WIDTH && piece->b1 <= whole->b1 + WIDTH);
    }
}

/* Converts a stack to arrays. */
static inline void build_windows(const struct gd__stack *from, struct gd__window_builder *out)
{
    check_ok(gd__window_builder_reserve(out, from->count), NULL);
    for (uint32_t i = 0; i < from->count; i++) gd__windows_put(&out->at, i, &from->windows[i]);
}

/* Converts a stack to children that may overlap from index `tangled` on. */
static inline void build_children(const struct gd__stack *from, uint32_t tangled,
                                  struct gd__pool *pool, struct gd__children *out)
{
    check_ok(gd__children_open(out, pool, from->count), NULL);
    for (uint32_t i = 0; i < from->count; i++) gd__windows_put(&out->at, i, &from->windows[i]);
    out->count = from->count;
    out->tangled = tangled;
    out->tangled_last = from->count - 1;
}

/* Converts arrays to a stack. */
static inline void load_windows(const struct gd__windows *from, uint32_t count,
                                struct gd__stack *out)
{
    check_ok(gd__stack_reserve(out, count + 1), NULL);
    out->count = 0;
    gd__stack_load(out, from, 0, count);
}
