/* Lines: a set of polylines in a picture, to be drawn with one pen. */
#pragma once

#include <stdint.h>

#include "gd/status.h"

/* Pixels from the picture's upper left corner. */
struct gd__pixel_point {
    float x, y;
};

/* An all-zero struct is empty. */
struct gd__lines {
    struct gd__pixel_point *places;
    uint32_t *ends; /* for each line, index of the position after its last one */
    uint32_t place_count, place_capacity, count, capacity;
    enum gd_status status; /* the first failure, after which lines are missing */
};

void gd__lines_free(struct gd__lines *lines); /* leaves it empty */

/* Adds a position to the current line; gd__lines_end ends the line. */
void gd__lines_add(struct gd__lines *lines, double x, double y);
void gd__lines_end(struct gd__lines *lines);

/* Simplifies the last line: removes positions within `tolerance` pixels of the remaining line. */
void gd__lines_simplify(struct gd__lines *lines, double tolerance);

/* Appends the dashes of all lines to `out`: dashes of `on` pixels with gaps of `off` pixels. */
void gd__lines_dash(const struct gd__lines *lines, double on, double off, struct gd__lines *out);

/* Returns the index of the first position of line i. */
static inline uint32_t gd__line_begin(const struct gd__lines *lines, uint32_t i)
{
    return i ? lines->ends[i - 1] : 0;
}
