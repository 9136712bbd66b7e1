#include "tests/samples/triangulation.h"

#include <stdlib.h>

__extension__ typedef __int128 wide;

int64_t triangulation_orientation(const int64_t a[2], const int64_t b[2], const int64_t c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int64_t turn(const struct triangulation *t, uint32_t a, uint32_t b, uint32_t c)
{
    return triangulation_orientation(t->points[a], t->points[b], t->points[c]);
}

/* Returns whether d lies inside the circle through a, b, c, which are counter-clockwise. */
static bool is_in_circle(const struct triangulation *t, uint32_t a, uint32_t b, uint32_t c,
                         uint32_t d)
{
    const int64_t *corner[3] = {t->points[a], t->points[b], t->points[c]}, *origin = t->points[d];
    int64_t x[3], y[3];
    for (int k = 0; k < 3; k++) x[k] = corner[k][0] - origin[0], y[k] = corner[k][1] - origin[1];
    wide determinant = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        determinant += (wide)(x[k] * x[k] + y[k] * y[k]) * (x[i] * y[j] - x[j] * y[i]);
    }
    return determinant > 0;
}

/* Returns the triangle with the directed edge a -> b, rotated to begin with it, or NULL. */
static uint32_t *seek(struct triangulation *t, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < t->triangle_count; i++) {
        uint32_t *corner = t->triangles[i];
        for (int k = 0; k < 3; k++) {
            if (corner[k] != a || corner[(k + 1) % 3] != b) continue;
            uint32_t apex = corner[(k + 2) % 3];
            corner[0] = a, corner[1] = b, corner[2] = apex;
            return corner;
        }
    }
    return NULL;
}

/* Replaces the common diagonal a-b of two triangles by c-d. c is to the left of a -> b. */
static void flip(uint32_t *left, uint32_t *right)
{
    uint32_t a = left[0], b = left[1], c = left[2], d = right[2];
    left[0] = a, left[1] = d, left[2] = c;
    right[0] = d, right[1] = b, right[2] = c;
}

/* Restores the Delaunay property from the edge a -> b outwards. The edge's triangle has the new
 * point p as its apex. */
static void legalise(struct triangulation *t, uint32_t a, uint32_t b, uint32_t p)
{
    uint32_t *outside = seek(t, b, a), *inside = seek(t, a, b);
    if (!outside || !is_in_circle(t, a, b, p, outside[2])) return;
    uint32_t d = outside[2];
    flip(inside, outside);
    legalise(t, a, d, p);
    legalise(t, d, b, p);
}

bool triangulation_start(struct triangulation *t, int64_t width, int64_t height, uint32_t capacity)
{
    const int64_t corners[4][2] = {{0, 0}, {width, 0}, {width, height}, {0, height}};
    const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    *t = (struct triangulation){
        .point_capacity = capacity + 4, .point_count = 4, .triangle_count = 2};
    t->points = malloc(t->point_capacity * sizeof *t->points);
    t->triangles = malloc(2 * (size_t)t->point_capacity * sizeof *t->triangles);
    if (!t->points || !t->triangles) return false;
    for (int i = 0; i < 4; i++) t->points[i][0] = corners[i][0], t->points[i][1] = corners[i][1];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) t->triangles[i][k] = triangles[i][k];
    return true;
}

void triangulation_free(struct triangulation *t)
{
    free(t->points);
    free(t->triangles);
    *t = (struct triangulation){0};
}

static uint32_t *triangle_around(struct triangulation *t, uint32_t p)
{
    for (uint32_t i = 0; i < t->triangle_count; i++) {
        uint32_t *corner = t->triangles[i];
        if (turn(t, corner[0], corner[1], p) >= 0 && turn(t, corner[1], corner[2], p) >= 0 &&
            turn(t, corner[2], corner[0], p) >= 0)
            return corner;
    }
    return NULL;
}

/* If the point lies on an edge, one of the three new triangles is degenerate. The circumcircle of
 * this triangle is a half-plane, which contains the apex on the other side of the edge. So legalise
 * flips the edge, and this removes the degenerate triangle. */
uint32_t triangulation_insert(struct triangulation *t, int64_t x, int64_t y)
{
    uint32_t p = t->point_count++;
    t->points[p][0] = x, t->points[p][1] = y;
    uint32_t *around = triangle_around(t, p), a = around[0], b = around[1], c = around[2];
    uint32_t(*fresh)[3] = &t->triangles[t->triangle_count];
    t->triangle_count += 2;
    around[2] = p;
    fresh[0][0] = b, fresh[0][1] = c, fresh[0][2] = p;
    fresh[1][0] = c, fresh[1][1] = a, fresh[1][2] = p;
    legalise(t, a, b, p);
    legalise(t, b, c, p);
    legalise(t, c, a, p);
    return p;
}

static bool opposite(int64_t a, int64_t b)
{
    return (a < 0 && b > 0) || (a > 0 && b < 0);
}

static bool cross(const struct triangulation *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    return opposite(turn(t, a, b, c), turn(t, a, b, d)) &&
           opposite(turn(t, c, d, a), turn(t, c, d, b));
}

/* Writes the edges that cross a-b to `edges`, which must have room for all of them. Returns their
 * number. */
static uint32_t edges_across(const struct triangulation *t, uint32_t a, uint32_t b,
                             uint32_t (*edges)[2])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < t->triangle_count; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t c = t->triangles[i][k], d = t->triangles[i][(k + 1) % 3];
            if (c > d || !cross(t, a, b, c, d)) continue;
            edges[count][0] = c, edges[count][1] = d;
            count++;
        }
    }
    return count;
}

/* Flips the crossing edges in turn. If an edge can't be flipped yet, or still crosses a-b after the
 * flip, it is tried again later (S. W. Sloan, "A fast algorithm for generating constrained Delaunay
 * triangulations", 1993). */
bool triangulation_constrain(struct triangulation *t, uint32_t a, uint32_t b)
{
    uint32_t(*ring)[2] = malloc(3 * (size_t)t->triangle_count * sizeof *ring);
    if (!ring) return false;
    uint32_t size = edges_across(t, a, b, ring);
    for (uint32_t head = 0, waiting = size; waiting > 0; head = (head + 1) % size) {
        uint32_t c = ring[head][0], d = ring[head][1], *left = seek(t, c, d),
                 *right = seek(t, d, c);
        uint32_t e = left[2], f = right[2], tail = (head + waiting) % size;
        waiting--;
        if (cross(t, c, d, e, f)) {
            flip(left, right);
            c = e, d = f;
            if (!cross(t, a, b, c, d)) continue;
        }
        ring[tail][0] = c, ring[tail][1] = d;
        waiting++;
    }
    free(ring);
    return true;
}
