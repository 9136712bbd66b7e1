/* Line: the polyline of a trace under construction, with its length and limits. Normalised unit. */
#ifndef GD_TRANSPORT_LINE_H
#define GD_TRANSPORT_LINE_H

#include "gd/control.h"
#include "gd/path.h"
#include "mesh/topology.h"

struct gd__line {
    struct gd_point *points;
    uint32_t count, capacity;
    uint32_t limit;     /* largest number of points after the first */
    double length;      /* requested length */
    double gone, carry; /* gone + carry is the length of the segments so far */
    const struct gd_control *control;
    /* number of other lines that grow at the same time and share the budget */
    uint32_t others;
    enum gd_status status; /* the first failure */
};

/* Increases the capacity and checks the control. Returns false if this fails, and also if the limit
 * is reached; in the latter case the status is GD_OK. */
bool gd__line_grow(struct gd__line *line);

static inline double gd__line_rest(const struct gd__line *line)
{
    return line->length - line->gone - line->carry;
}

/* Adds `run` to `gone` by Neumaier's compensated summation: `carry` collects the rounding
 * errors. */
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
