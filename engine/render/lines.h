/* Lines: polylines in a picture, of one kind: drawn with one pen. */
#ifndef GD_RENDER_LINES_H
#define GD_RENDER_LINES_H

#include <stdint.h>

#include "gd/status.h"

/* Pixels from the picture's upper left corner. */
struct gd__place {
    float x, y;
};

/* All zero is none. */
struct gd__lines {
    struct gd__place *places;
    uint32_t *ends; /* of each line in `places` */
    uint32_t place_count, place_capacity, count, capacity;
    enum gd_status status; /* of the first failure: lines are missing then */
};

void gd__lines_free(struct gd__lines *lines); /* leaves none */

/* Adds a place to the line that is being made; gd__lines_end ends it. */
void gd__lines_add(struct gd__lines *lines, double x, double y);
void gd__lines_end(struct gd__lines *lines);

/* Leaves out places of the last line that are nowhere farther than `tolerance` pixels from what is
 * left. */
void gd__lines_simplify(struct gd__lines *lines, double tolerance);

/* Adds the dashes of all lines: `on` pixels drawn, `off` not, in turn. */
void gd__lines_dash(const struct gd__lines *lines, double on, double off, struct gd__lines *out);

/* Where line i begins. */
static inline uint32_t gd__line_begin(const struct gd__lines *lines, uint32_t i)
{
    return i ? lines->ends[i - 1] : 0;
}

#endif
