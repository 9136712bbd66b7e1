#include "tests/oracle/visibility.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

struct visibility {
    const struct visibility_scene *scene;
    double source[2];
    double *distance; /* the distance of each corner from the source */
};

static double orientation(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool is_same(const double a[2], const double b[2])
{
    return a[0] == b[0] && a[1] == b[1];
}

/* Returns whether p lies on the closed segment a-b. */
static bool is_on(const double a[2], const double b[2], const double p[2])
{
    return orientation(a, b, p) == 0 && fmin(a[0], b[0]) <= p[0] && p[0] <= fmax(a[0], b[0]) &&
           fmin(a[1], b[1]) <= p[1] && p[1] <= fmax(a[1], b[1]);
}

static bool do_cross(const double a[2], const double b[2], const double c[2], const double d[2])
{
    return orientation(a, b, c) * orientation(a, b, d) < 0 &&
           orientation(c, d, a) * orientation(c, d, b) < 0;
}

/* Returns whether p lies strictly inside the polygon. */
static bool is_inside(const struct visibility_scene *scene, uint32_t polygon, const double p[2])
{
    bool inside = false;
    uint32_t begin = scene->first[polygon], end = scene->first[polygon + 1];
    for (uint32_t i = begin; i < end; i++) {
        const double *a = scene->corners[i], *b = scene->corners[i + 1 < end ? i + 1 : begin];
        if (is_on(a, b, p)) return false;
        if ((a[1] > p[1]) != (b[1] > p[1]) && (orientation(a, b, p) > 0) == (b[1] > a[1]))
            inside = !inside;
    }
    return inside;
}

/* Returns whether b is visible from a. If a corner lies on the segment, b counts as hidden, because
 * the visibility graph has the two segments that end at the corner. If no side crosses the segment
 * and no corner lies on it, the segment is inside an obstacle exactly if its midpoint is inside. */
static bool is_visible(const struct visibility_scene *scene, const double a[2], const double b[2])
{
    double middle[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
    for (uint32_t polygon = 0; polygon < scene->count; polygon++) {
        uint32_t begin = scene->first[polygon], end = scene->first[polygon + 1];
        for (uint32_t i = begin; i < end; i++) {
            const double *c = scene->corners[i], *d = scene->corners[i + 1 < end ? i + 1 : begin];
            if (!is_same(c, a) && !is_same(c, b) && is_on(a, b, c)) return false;
            if (do_cross(a, b, c, d)) return false;
        }
        if (is_inside(scene, polygon, middle)) return false;
    }
    return true;
}

static double between(const double a[2], const double b[2])
{
    return hypot(a[0] - b[0], a[1] - b[1]);
}

static void settle_corners(struct visibility *visibility, bool *settled)
{
    const struct visibility_scene *scene = visibility->scene;
    uint32_t total = scene->first[scene->count];
    double *distance = visibility->distance;
    for (uint32_t i = 0; i < total; i++)
        distance[i] = is_visible(scene, visibility->source, scene->corners[i])
                          ? between(visibility->source, scene->corners[i])
                          : INFINITY;
    for (uint32_t step = 0; step < total; step++) {
        uint32_t next = total;
        for (uint32_t i = 0; i < total; i++)
            if (!settled[i] && (next == total || distance[i] < distance[next])) next = i;
        settled[next] = true;
        for (uint32_t i = 0; i < total; i++) {
            double through = distance[next] + between(scene->corners[next], scene->corners[i]);
            if (through < distance[i] && is_visible(scene, scene->corners[next], scene->corners[i]))
                distance[i] = through;
        }
    }
}

struct visibility *visibility_create(const struct visibility_scene *scene, const double source[2])
{
    struct visibility *visibility = calloc(1, sizeof *visibility);
    bool *settled = calloc(scene->first[scene->count] + 1, sizeof *settled);
    if (visibility)
        visibility->distance = calloc(scene->first[scene->count] + 1, sizeof *visibility->distance);
    if (!visibility || !settled || !visibility->distance) {
        visibility_free(visibility);
        free(settled);
        return NULL;
    }
    visibility->scene = scene;
    visibility->source[0] = source[0], visibility->source[1] = source[1];
    settle_corners(visibility, settled);
    free(settled);
    return visibility;
}

void visibility_free(struct visibility *visibility)
{
    if (!visibility) return;
    free(visibility->distance);
    free(visibility);
}

double visibility_distance(const struct visibility *visibility, const double target[2])
{
    const struct visibility_scene *scene = visibility->scene;
    double best = is_visible(scene, visibility->source, target)
                      ? between(visibility->source, target)
                      : INFINITY;
    for (uint32_t i = 0; i < scene->first[scene->count]; i++) {
        double through = visibility->distance[i] + between(scene->corners[i], target);
        if (through < best && is_visible(scene, scene->corners[i], target)) best = through;
    }
    return best;
}
