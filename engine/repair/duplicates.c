/* Finds polygons with the same set of vertices. Groups polygons by their lowest vertex, and sorts
 * each group by the other vertices. */
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "base/slices.h"
#include "repair/repair.h"

struct comparison {
    const struct gd_polygons *polygons;
    /* the corners of the polygons; those of each polygon are in ascending order */
    const uint32_t *sorted;
    struct gd__pace *pace;
};

static int compare_indices(const void *x, const void *y)
{
    uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
    return a < b ? -1 : a > b;
}

/* Compares two polygons by their number of corners, then by their vertices. */
static int compare_sets(const struct comparison *comparison, uint32_t i, uint32_t j)
{
    uint32_t m = gd_polygons_size(comparison->polygons, i),
             n = gd_polygons_size(comparison->polygons, j);
    if (m != n) return m < n ? -1 : 1;
    const uint32_t *a = comparison->sorted + gd_polygons_first(comparison->polygons, i);
    const uint32_t *b = comparison->sorted + gd_polygons_first(comparison->polygons, j);
    for (uint32_t k = 0; k < n; k++) {
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    }
    return 0;
}

static int compare_polygons(const void *x, const void *y, void *comparison)
{
    int order = compare_sets(comparison, *(const uint32_t *)x, *(const uint32_t *)y);
    return order ? order : compare_indices(x, y);
}

static void sort_corners(const struct gd_polygons *polygons, struct gd__pace *pace,
                         uint32_t *sorted)
{
    GD__PACED (pace, c, gd_polygons_corner_count(polygons)) sorted[c] = polygons->corners[c];
    GD__PACED (pace, i, polygons->polygon_count)
        qsort(sorted + gd_polygons_first(polygons, i), gd_polygons_size(polygons, i),
              sizeof *sorted, compare_indices);
}

/* Fills `order` with the polygons that have corners, ordered by their lowest vertex. The polygons
 * of vertex v are order[start[v+1] .. start[v+2]). */
static void bucket(const struct comparison *comparison, uint32_t *start, uint32_t *order)
{
    const struct gd_polygons *polygons = comparison->polygons;
    GD__PACED (comparison->pace, i, polygons->polygon_count) {
        if (gd_polygons_size(polygons, i))
            start[comparison->sorted[gd_polygons_first(polygons, i)] + 1]++;
    }
    GD__PACED (comparison->pace, v, polygons->position_count + 1) start[v + 1] += start[v];
    gd__slices_touch(comparison->pace, order, polygons->polygon_count * sizeof *order);
    GD__PACED (comparison->pace, done, polygons->polygon_count) {
        uint32_t i = polygons->polygon_count - 1 - done;
        if (gd_polygons_size(polygons, i))
            order[--start[comparison->sorted[gd_polygons_first(polygons, i)] + 1]] = i;
    }
}

static void name_originals(struct comparison *comparison, const uint32_t *start, uint32_t *order,
                           uint32_t *original)
{
    const struct gd_polygons *polygons = comparison->polygons;
    GD__PACED (comparison->pace, i, polygons->polygon_count) original[i] = i;
    GD__PACED (comparison->pace, v, polygons->position_count) {
        uint32_t *same = order + start[v + 1], count = start[v + 2] - start[v + 1];
        if (count > 1) qsort_r(same, count, sizeof *same, compare_polygons, comparison);
        for (uint32_t k = 1; k < count; k++) {
            if (compare_sets(comparison, same[k - 1], same[k]) == 0)
                original[same[k]] = original[same[k - 1]];
        }
    }
}

enum gd_status gd__find_duplicates(const struct gd_polygons *polygons, struct gd__pace *pace,
                                   uint32_t *original)
{
    uint32_t *sorted =
        gd__large_array((size_t)gd_polygons_corner_count(polygons) + 1, sizeof *sorted);
    uint32_t *start = gd__large_zeroed((size_t)polygons->position_count + 2, sizeof *start);
    uint32_t *order = gd__large_array((size_t)polygons->polygon_count + 1, sizeof *order);
    enum gd_status status = sorted && start && order ? GD_OK : GD_NO_MEMORY;
    if (!status) {
        struct comparison comparison = {polygons, sorted, pace};
        sort_corners(polygons, pace, sorted);
        bucket(&comparison, start, order);
        name_originals(&comparison, start, order, original);
    }
    free(sorted);
    free(start);
    free(order);
    return status ? status : pace->status;
}
