/* Windows of one list as a structure of arrays. Kernels read and write them several lanes at a
 * time. Arrays have room for whole groups of GD__WINDOWS_GROUP windows, because kernels read and
 * write whole groups. A kernel may overwrite up to one group behind the last window, and read up to
 * one group before the first window. The contents of these groups are undefined. */
#pragma once

#include <stddef.h>

#include "gd/polygons.h"
#include "gd/status.h"
#include "window/window.h"

#define GD__WINDOWS_GROUP 8 /* largest number of lanes of a kernel */
/* bytes per window: five doubles and the source, rounded up so that groups fill cache lines */
#define GD__WINDOWS_BYTES 48

struct gd__windows {
    double *b0, *b1, *x, *y, *sigma;
    uint32_t *source;
};

/* Returns the arrays in a block of capacity * GD__WINDOWS_BYTES bytes, 64-byte aligned. `capacity`
 * is a multiple of the group. */
static inline struct gd__windows gd__windows_at(void *block, uint32_t capacity)
{
    double *first = block;
    return (struct gd__windows){first,
                                first + capacity,
                                first + 2 * (size_t)capacity,
                                first + 3 * (size_t)capacity,
                                first + 4 * (size_t)capacity,
                                (uint32_t *)(first + 5 * (size_t)capacity)};
}

static inline struct gd__window gd__windows_get(const struct gd__windows *w, uint32_t i)
{
    return (struct gd__window){w->b0[i], w->b1[i], w->x[i], w->y[i], w->sigma[i], w->source[i], 0};
}

static inline void gd__windows_put(const struct gd__windows *w, uint32_t i,
                                   const struct gd__window *window)
{
    w->b0[i] = window->b0;
    w->b1[i] = window->b1;
    w->x[i] = window->x;
    w->y[i] = window->y;
    w->sigma[i] = window->sigma;
    w->source[i] = window->source;
}

/* Returns the windows from index `first` on. */
static inline struct gd__windows gd__windows_from(const struct gd__windows *w, uint32_t first)
{
    return (struct gd__windows){w->b0 + first, w->b1 + first,    w->x + first,
                                w->y + first,  w->sigma + first, w->source + first};
}

/* Copies `count` windows. Copies whole groups, so it may overwrite up to one group behind the
 * copied windows. The ranges must not overlap. */
static inline void gd__windows_copy(const struct gd__windows *to, uint32_t at,
                                    const struct gd__windows *from, uint32_t first, uint32_t count)
{
    for (uint32_t i = 0; i < count; i += GD__WINDOWS_GROUP) {
        __builtin_memcpy(to->b0 + at + i, from->b0 + first + i, GD__WINDOWS_GROUP * sizeof(double));
        __builtin_memcpy(to->b1 + at + i, from->b1 + first + i, GD__WINDOWS_GROUP * sizeof(double));
        __builtin_memcpy(to->x + at + i, from->x + first + i, GD__WINDOWS_GROUP * sizeof(double));
        __builtin_memcpy(to->y + at + i, from->y + first + i, GD__WINDOWS_GROUP * sizeof(double));
        __builtin_memcpy(to->sigma + at + i, from->sigma + first + i,
                         GD__WINDOWS_GROUP * sizeof(double));
        __builtin_memcpy(to->source + at + i, from->source + first + i,
                         GD__WINDOWS_GROUP * sizeof(uint32_t));
    }
}

/* Moves `count` windows within their list. */
static inline void gd__windows_move(const struct gd__windows *w, uint32_t to, uint32_t from,
                                    uint32_t count)
{
    __builtin_memmove(w->b0 + to, w->b0 + from, count * sizeof(double));
    __builtin_memmove(w->b1 + to, w->b1 + from, count * sizeof(double));
    __builtin_memmove(w->x + to, w->x + from, count * sizeof(double));
    __builtin_memmove(w->y + to, w->y + from, count * sizeof(double));
    __builtin_memmove(w->sigma + to, w->sigma + from, count * sizeof(double));
    __builtin_memmove(w->source + to, w->source + from, count * sizeof(uint32_t));
}

/* Windows under construction, in a block that grows. A struct that is all zero has no windows. */
struct gd__window_builder {
    struct gd__windows at;
    uint32_t capacity; /* number of windows that fit, without the group behind them */
    void *block;
};

/* Makes room for that many windows. Keeps the existing windows. Errors: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__window_builder_reserve(struct gd__window_builder *builder,
                                                      uint32_t count);
void gd__window_builder_destroy(struct gd__window_builder *builder);
