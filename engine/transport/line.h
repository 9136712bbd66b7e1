/* Line: the polyline of a trace as it grows: points, length, limits. Inside unit. */
#ifndef GD_TRANSPORT_LINE_H
#define GD_TRANSPORT_LINE_H

#include "gd/control.h"
#include "gd/path.h"
#include "mesh/topology.h"

struct gd__line {
    struct gd_point *points;
    uint32_t count, capacity;
    uint32_t limit;     /* points, the first one not counted */
    double length;      /* that was asked for */
    double gone, carry; /* sum of the segments: gone + carry */
    const struct gd_control *control;
    uint32_t others;       /* lines that grow at the same time, out of the same budget */
    enum gd_status status; /* sticky: the first failure */
};

/* Room for more points, with a look at the control; false: a failure, or the limit (status GD_OK).
 * Called when the room is used up, which doubles, and so is looked at seldom. */
bool gd__line_grow(struct gd__line *line);

static inline double gd__line_rest(const struct gd__line *line)
{
    return line->length - line->gone - line->carry;
}

/* Neumaier's sum: what rounding takes from `gone` is carried. */
static inline void gd__line_go(struct gd__line *line, double run)
{
    double sum = line->gone + run;
    line->carry += line->gone >= run ? (line->gone - sum) + run : (run - sum) + line->gone;
    line->gone = sum;
}

static inline bool gd__line_append(struct gd__line *line, const struct gd_point *point, double run)
{
    if (line->count == line->capacity && !gd__line_grow(line)) return false;
    line->points[line->count++] = *point;
    gd__line_go(line, run);
    return true;
}

static inline struct gd_point *gd__line_last(const struct gd__line *line)
{
    return &line->points[line->count - 1];
}

#endif
