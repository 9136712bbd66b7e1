/* A polyline that lies exactly on a surface. It proves that a distance is no longer than the
 * polyline.
 *
 * When two solvers disagree on a distance, their paths decide. The shorter polyline proves that the
 * other distance is too long, whatever error either solver reports. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "gd/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The point (1 - t) a + t b of the edge between two vertices. A vertex has a == b. */
struct polyline_point {
    uint32_t a, b;
    double t;
};

/* A polyline that grows when points are added. If all members are zero, the polyline is empty. */
struct polyline {
    struct polyline_point *points; /* owned */
    uint32_t count, capacity;
    bool failed; /* out of memory */
};

void polyline_add(struct polyline *line, struct polyline_point point);
void polyline_free(struct polyline *line); /* also sets all members to zero */

/* Returns the length in long double. Returns NAN unless consecutive points share a triangle and the
 * ends are the two vertices, in either order. O(count x triangles). */
long double polyline_length(const struct polyline *line, const struct gd_polygons *triangles,
                            uint32_t from, uint32_t to);

#ifdef __cplusplus
}
#endif
