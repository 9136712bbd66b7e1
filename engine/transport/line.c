#include "transport/line.h"

#include <stdlib.h>

enum {
    FIRST = 64,   /* initial capacity */
    CHUNK = 16384 /* number of points between two checks of the control (a millisecond) */
};

static uint32_t next_capacity(const struct gd__line *line)
{
    uint32_t doubled = line->capacity ? 2 * line->capacity : FIRST,
             stepped = line->capacity + CHUNK;
    uint32_t capacity = doubled < stepped ? doubled : stepped;
    return capacity < line->limit + 1 ? capacity : line->limit + 1;
}

bool gd__line_grow(struct gd__line *line)
{
    uint32_t capacity = next_capacity(line);
    if (line->status || capacity <= line->count) return false;
    double part = line->length > 0 ? fmin((line->gone + line->carry) / line->length, 1) : 0;
    line->status = gd_control_check(line->control, part);
    if (!line->status)
        line->status = gd_control_afford(line->control, (line->others + (size_t)1) *
                                                            ((size_t)capacity + line->capacity) *
                                                            sizeof *line->points);
    if (line->status) return false;
    struct gd_point *points = realloc(line->points, capacity * sizeof *points);
    if (!points) {
        line->status = GD_NO_MEMORY;
        return false;
    }
    line->points = points;
    line->capacity = capacity;
    return true;
}
