/* A polyline on a surface, written so that it lies there exactly: the witness that a distance is no
 * longer than it.
 *
 * Two solvers that disagree on a distance are judged by their paths: whoever comes with the shorter
 * polyline is right about the other, whatever either says about its own error. */
#ifndef TESTS_ORACLE_CGAL_POLYLINE_H
#define TESTS_ORACLE_CGAL_POLYLINE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The point (1 - t) a + t b of the edge between two vertices; a vertex is a == b. */
struct polyline_point {
    uint32_t a, b;
    double t;
};

/* Grows as points are added; starts all-zero. */
struct polyline {
    struct polyline_point *points; /* malloc'ed */
    uint32_t count, capacity;
    bool failed; /* memory is out */
};

void polyline_add(struct polyline *line, struct polyline_point point);
void polyline_free(struct polyline *line); /* and zeroes it */

/* Its length, in long double; NAN unless consecutive points share a triangle and the ends are the
 * two vertices, in either order. O(count x triangles). */
long double polyline_length(const struct polyline *line, const struct gd_polygons *triangles,
                            uint32_t from, uint32_t to);

#ifdef __cplusplus
}
#endif

#endif
