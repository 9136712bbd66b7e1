#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/samples/triangulation.h"

/* The ground is a rectangle with integer coordinates. `scale` maps these coordinates exactly to
 * [0,1] x [0,0.75]. */
static const int64_t width = 1 << 20, height = 3 << 18;
static const double scale = 0x1p-20;

/* The height is more than half of the rectangle's perimeter, so a path around a prism is always
 * shorter than a path over the prism. */
static const double prism_height = 2;

enum {
    MIN_CORNERS = 3,
    MAX_CORNERS = 9,
    /* number of the first corner of an obstacle; the rectangle's corners, p and q precede it */
    FIRST_CORNER = 6
};

/* A disc that contains one obstacle. Discs are disjoint. */
struct disc {
    double x, y, radius;
};

static bool is_apart(const struct disc *discs, uint32_t count, struct disc disc)
{
    double gap = 0.1 * disc.radius, margin = disc.radius + gap;
    if (disc.x < margin || disc.y < margin || disc.x > (double)width - margin ||
        disc.y > (double)height - margin)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (hypot(discs[i].x - disc.x, discs[i].y - disc.y) < discs[i].radius + disc.radius + gap)
            return false;
    return true;
}

/* Places random disjoint discs. After every 64 attempts, further discs are smaller, so that room is
 * found for all. The first two discs contain p and q. */
static void throw_discs(struct disc *discs, uint32_t count, struct rng *rng)
{
    double largest = 0.55 * sqrt((double)width * (double)height / count);
    discs[0] = (struct disc){0.04 * (double)width, rng_between(rng, 0.2, 0.8) * (double)height,
                             0.01 * (double)width};
    discs[1] = (struct disc){0.96 * (double)width, rng_between(rng, 0.2, 0.8) * (double)height,
                             0.01 * (double)width};
    for (uint32_t placed = 2, thrown = 0; placed < count; thrown++) {
        struct disc disc = {rng_unit(rng) * (double)width, rng_unit(rng) * (double)height,
                            largest * rng_between(rng, 0.4, 1)};
        if (is_apart(discs, placed, disc)) discs[placed++] = disc;
        if (thrown % 64 == 63) largest *= 0.95;
    }
}

/* Adds a polygon in the disc. The polygon is star-shaped about the disc's centre. A convex polygon
 * has its corners on the circle. Returns the number of corners. */
static uint32_t cut_polygon(struct triangulation *plane, struct disc disc, bool convex,
                            struct rng *rng)
{
    uint32_t corners = MIN_CORNERS + rng_below(rng, MAX_CORNERS - MIN_CORNERS + 1);
    double start = rng_between(rng, 0, 2 * M_PI);
    for (uint32_t k = 0; k < corners; k++) {
        double angle = start + 2 * M_PI * (k + rng_between(rng, -0.2, 0.2)) / corners;
        double reach = convex ? disc.radius : disc.radius * rng_between(rng, 0.25, 1);
        triangulation_insert(plane, llround(disc.x + reach * cos(angle)),
                             llround(disc.y + reach * sin(angle)));
    }
    return corners;
}

/* Triangulates the rectangle, p, q and the corners of all obstacles. The obstacles' sides become
 * edges. */
static enum gd_status draw_plan(uint32_t count, struct rng *rng, struct triangulation *plane,
                                struct sample_obstacles *out)
{
    struct disc *discs = malloc((count + 2) * sizeof *discs);
    out->first = calloc(count + 1, sizeof *out->first);
    if (!discs || !out->first ||
        !triangulation_start(plane, width, height, 2 + count * MAX_CORNERS)) {
        free(discs);
        return GD_NO_MEMORY;
    }
    throw_discs(discs, count + 2, rng);
    out->count = count;
    out->p = triangulation_insert(plane, llround(discs[0].x), llround(discs[0].y));
    out->q = triangulation_insert(plane, llround(discs[1].x), llround(discs[1].y));
    for (uint32_t i = 0; i < count; i++)
        out->first[i + 1] = out->first[i] + cut_polygon(plane, discs[i + 2], i % 2 == 0, rng);
    free(discs);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t begin = FIRST_CORNER + out->first[i], end = FIRST_CORNER + out->first[i + 1];
        for (uint32_t v = begin; v < end; v++)
            if (!triangulation_constrain(plane, v, v + 1 < end ? v + 1 : begin))
                return GD_NO_MEMORY;
    }
    return GD_OK;
}

static enum gd_status copy_corners(const struct triangulation *plane, struct sample_obstacles *out)
{
    uint32_t total = out->first[out->count];
    out->corners = malloc((total + 1) * sizeof *out->corners);
    if (!out->corners) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < total; i++)
        for (int k = 0; k < 2; k++)
            out->corners[i][k] = scale * (double)plane->points[FIRST_CORNER + i][k];
    return GD_OK;
}

/* Returns whether the triangle's centroid lies in the obstacle, by the number of sides that a ray
 * to the right crosses. */
static bool is_inside(const struct triangulation *plane, const uint32_t triangle[3], uint32_t begin,
                      uint32_t end)
{
    int64_t centre[2] = {0, 0};
    for (int k = 0; k < 3; k++)
        centre[0] += plane->points[triangle[k]][0], centre[1] += plane->points[triangle[k]][1];
    bool inside = false;
    for (uint32_t v = begin; v < end; v++) {
        const int64_t *p = plane->points[v], *q = plane->points[v + 1 < end ? v + 1 : begin];
        int64_t a[2] = {3 * p[0], 3 * p[1]}, b[2] = {3 * q[0], 3 * q[1]};
        if ((a[1] > centre[1]) == (b[1] > centre[1])) continue;
        inside ^= (triangulation_orientation(a, b, centre) > 0) == (b[1] > a[1]);
    }
    return inside;
}

static bool is_roof(const struct triangulation *plane, const struct sample_obstacles *plan,
                    const uint32_t triangle[3])
{
    for (uint32_t i = 0; i < plan->count; i++) {
        uint32_t begin = FIRST_CORNER + plan->first[i], end = FIRST_CORNER + plan->first[i + 1];
        if (triangle[0] >= begin && triangle[0] < end)
            return is_inside(plane, triangle, begin, end);
    }
    return false;
}

/* Makes the ground and the roofs from the plan's triangles, and walls from the obstacles' sides.
 * The index of a corner's upper copy is the index of the corner plus `lift`. */
static enum gd_status raise_prisms(const struct triangulation *plane, struct sample_obstacles *out)
{
    struct sample_builder builder = {0};
    uint32_t corners = out->first[out->count], lift = corners;
    for (uint32_t v = 0; v < plane->point_count; v++)
        sample_add_vertex(&builder, scale * (double)plane->points[v][0],
                          scale * (double)plane->points[v][1], 0);
    for (uint32_t i = 0; i < corners; i++)
        sample_add_vertex(&builder, out->corners[i][0], out->corners[i][1], prism_height);
    for (uint32_t i = 0; i < plane->triangle_count; i++) {
        const uint32_t *corner = plane->triangles[i], up = is_roof(plane, out, corner) ? lift : 0;
        sample_add_triangle(&builder, corner[0] + up, corner[1] + up, corner[2] + up);
    }
    for (uint32_t i = 0; i < out->count; i++) {
        uint32_t begin = FIRST_CORNER + out->first[i], end = FIRST_CORNER + out->first[i + 1];
        for (uint32_t v = begin; v < end; v++) {
            uint32_t next = v + 1 < end ? v + 1 : begin;
            sample_add_quad(&builder, v, next, next + lift, v + lift);
        }
    }
    return sample_finish(&builder, &out->mesh);
}

enum gd_status sample_obstacles(uint32_t count, uint32_t level, uint64_t seed,
                                struct sample_obstacles *out)
{
    struct rng rng = {seed};
    struct triangulation plane = {0};
    struct sample_obstacles made = {0};
    enum gd_status status = draw_plan(count, &rng, &plane, &made);
    if (status == GD_OK) status = copy_corners(&plane, &made);
    if (status == GD_OK) status = raise_prisms(&plane, &made);
    for (uint32_t i = 0; i < level && status == GD_OK; i++) status = sample_subdivide(&made.mesh);
    triangulation_free(&plane);
    if (status == GD_OK)
        *out = made;
    else
        sample_obstacles_free(&made);
    return status;
}

void sample_obstacles_free(struct sample_obstacles *obstacles)
{
    gd_polygons_free(&obstacles->mesh);
    free(obstacles->first);
    free(obstacles->corners);
    *obstacles = (struct sample_obstacles){0};
}
