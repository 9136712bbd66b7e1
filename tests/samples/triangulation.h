/* Triangulation: constrained Delaunay triangulation of points with integer coordinates in a
 * rectangle. All predicates are exact and need no tolerance. Suitable for some thousand points,
 * because searches are linear. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct triangulation {
    int64_t (*points)[2]; /* |coordinate| <= 2^21 */
    uint32_t point_count, point_capacity;
    uint32_t (*triangles)[3]; /* counter-clockwise */
    uint32_t triangle_count;
};

/* Returns a positive number if a, b, c are counter-clockwise, and 0 if they are collinear. */
int64_t triangulation_orientation(const int64_t a[2], const int64_t b[2], const int64_t c[2]);

/* Starts with the rectangle's corners (0,0), (width,0), (width,height), (0,height) as points 0 to
 * 3. Reserves memory for `capacity` more points. Returns false if out of memory. The caller frees
 * the triangulation by triangulation_free in any case. */
bool triangulation_start(struct triangulation *triangulation, int64_t width, int64_t height,
                         uint32_t capacity);
void triangulation_free(struct triangulation *triangulation);

/* Adds a point strictly inside the rectangle, different from all others, and returns its number.
 * All points must be added before the first constraint. */
uint32_t triangulation_insert(struct triangulation *triangulation, int64_t x, int64_t y);

/* Makes a-b an edge. It must not cross another constraint or pass through a point. Returns false if
 * out of memory. */
bool triangulation_constrain(struct triangulation *triangulation, uint32_t a, uint32_t b);
