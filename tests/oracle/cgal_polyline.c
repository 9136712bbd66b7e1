#include "tests/oracle/cgal_polyline.h"

#include <math.h>
#include <stdlib.h>

void polyline_add(struct polyline *line, struct polyline_point point)
{
    if (line->count == line->capacity) {
        uint32_t capacity = 2 * line->capacity + 16;
        struct polyline_point *grown = realloc(line->points, capacity * sizeof *grown);
        if (!grown) {
            line->failed = true;
            return;
        }
        line->points = grown;
        line->capacity = capacity;
    }
    line->points[line->count++] = point;
}

void polyline_free(struct polyline *line)
{
    free(line->points);
    *line = (struct polyline){0};
}

static bool is_in_triangle(const uint32_t corner[3], struct polyline_point p)
{
    bool has_a = corner[0] == p.a || corner[1] == p.a || corner[2] == p.a;
    bool has_b = corner[0] == p.b || corner[1] == p.b || corner[2] == p.b;
    return has_a && has_b && p.t >= 0 && p.t <= 1;
}

static bool share_triangle(const struct gd_polygons *triangles, struct polyline_point p,
                           struct polyline_point q)
{
    for (uint32_t f = 0; f < triangles->polygon_count; f++) {
        const uint32_t *corner = &triangles->corners[3 * f];
        if (is_in_triangle(corner, p) && is_in_triangle(corner, q)) return true;
    }
    return false;
}

static long double between(const struct gd_polygons *triangles, struct polyline_point p,
                           struct polyline_point q)
{
    long double d[3];
    for (int k = 0; k < 3; k++) {
        long double p0 = triangles->positions[p.a][k], p1 = triangles->positions[p.b][k];
        long double q0 = triangles->positions[q.a][k], q1 = triangles->positions[q.b][k];
        d[k] = (p0 + p.t * (p1 - p0)) - (q0 + q.t * (q1 - q0));
    }
    return hypotl(hypotl(d[0], d[1]), d[2]);
}

static bool is_vertex(struct polyline_point p, uint32_t vertex)
{
    return p.a == vertex && p.b == vertex;
}

long double polyline_length(const struct polyline *line, const struct gd_polygons *triangles,
                            uint32_t from, uint32_t to)
{
    if (line->failed || line->count == 0) return NAN;
    struct polyline_point first = line->points[0], last = line->points[line->count - 1];
    if (!(is_vertex(first, from) && is_vertex(last, to)) &&
        !(is_vertex(first, to) && is_vertex(last, from)))
        return NAN;
    long double length = 0;
    for (uint32_t i = 1; i < line->count; i++) {
        if (!share_triangle(triangles, line->points[i - 1], line->points[i])) return NAN;
        length += between(triangles, line->points[i - 1], line->points[i]);
    }
    return length;
}
