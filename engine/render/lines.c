#include "render/lines.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/array.h"

void gd__lines_free(struct gd__lines *lines)
{
    free(lines->places);
    free(lines->ends);
    *lines = (struct gd__lines){0};
}

void gd__lines_add(struct gd__lines *lines, double x, double y)
{
    const struct gd__pixel_point place = {(float)x, (float)y};
    enum gd_status status = gd__array_append(&lines->places, &lines->place_count,
                                             &lines->place_capacity, &place, sizeof place);
    if (status) lines->status = status;
}

void gd__lines_end(struct gd__lines *lines)
{
    if (lines->place_count <= gd__line_begin(lines, lines->count)) return;
    enum gd_status status = gd__array_append(&lines->ends, &lines->count, &lines->capacity,
                                             &lines->place_count, sizeof *lines->ends);
    if (status) lines->status = status;
}

/* --- simplification --------------------------------------------------------------------------- */

static double distance_to_segment(struct gd__pixel_point p, struct gd__pixel_point a,
                                  struct gd__pixel_point b)
{
    double x = (double)b.x - a.x, y = (double)b.y - a.y, px = (double)p.x - a.x,
           py = (double)p.y - a.y, length = x * x + y * y;
    double t = length > 0 ? fmin(fmax((px * x + py * y) / length, 0), 1) : 0;
    return hypot(px - t * x, py - t * y);
}

/* Returns true if the segment from position a to position b approximates all positions between
 * them. */
static bool stands_for(const struct gd__lines *lines, uint32_t a, uint32_t b, double tolerance)
{
    for (uint32_t i = a + 1; i < b; i++)
        if (distance_to_segment(lines->places[i], lines->places[a], lines->places[b]) > tolerance)
            return false;
    return true;
}

/* The algorithm is greedy. After a kept position, it keeps the last position for which a single
 * segment approximates all positions between the two. The result overwrites positions that were
 * already read. */
void gd__lines_simplify(struct gd__lines *lines, double tolerance)
{
    enum { FARTHEST = 64 };
    if (!lines->count || lines->status) return;
    uint32_t begin = gd__line_begin(lines, lines->count - 1), end = lines->place_count,
             kept = begin;
    for (uint32_t at = begin; at + 1 < end;) {
        uint32_t next = at + 1;
        while (next + 1 < end && next - at < FARTHEST && stands_for(lines, at, next + 1, tolerance))
            next++;
        at = next;
        lines->places[++kept] = lines->places[at];
    }
    lines->place_count = lines->ends[lines->count - 1] = kept + 1;
}

/* --- dashes ----------------------------------------------------------------------------------- */

static void dash_line(const struct gd__pixel_point *places, uint32_t count, double on, double off,
                      struct gd__lines *out)
{
    double left = on; /* remaining length of the current dash or gap */
    bool is_drawn = true;
    gd__lines_add(out, places[0].x, places[0].y);
    for (uint32_t i = 0; i + 1 < count; i++) {
        double x = (double)places[i + 1].x - places[i].x, y = (double)places[i + 1].y - places[i].y,
               length = hypot(x, y), done = 0;
        while (length - done > left) {
            done += left;
            gd__lines_add(out, places[i].x + x * done / length, places[i].y + y * done / length);
            if (is_drawn) gd__lines_end(out);
            is_drawn = !is_drawn;
            left = is_drawn ? on : off;
        }
        left -= length - done;
        if (is_drawn) gd__lines_add(out, places[i + 1].x, places[i + 1].y);
    }
    gd__lines_end(out);
}

void gd__lines_dash(const struct gd__lines *lines, double on, double off, struct gd__lines *out)
{
    for (uint32_t i = 0; i < lines->count; i++) {
        uint32_t begin = gd__line_begin(lines, i);
        dash_line(lines->places + begin, lines->ends[i] - begin, on, off, out);
    }
}
