/* See distinct.h. */
#include "server/query/distinct_points.h"

#include <stdlib.h>
#include <string.h>

struct listed {
    const struct gd_point *point;
    uint32_t index;
};

/* Zero for what gd_point_equal calls equal. */
static int compare(const void *a, const void *b)
{
    const struct gd_point *x = ((const struct listed *)a)->point,
                          *y = ((const struct listed *)b)->point;
    if (x->kind != y->kind) return x->kind < y->kind ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    return memcmp(x->weight, y->weight, sizeof x->weight);
}

bool server_distinct_find(const struct gd_point *points, uint32_t count,
                          struct server_distinct *out)
{
    struct server_distinct distinct = {
        .points = malloc(count * (sizeof *points + sizeof *distinct.number))};
    struct listed *sorted = malloc(count * sizeof *sorted);
    if (!distinct.points || !sorted) {
        free(sorted);
        free(distinct.points);
        return false;
    }
    distinct.number = (uint32_t *)(distinct.points + count);
    for (uint32_t i = 0; i < count; i++) sorted[i] = (struct listed){&points[i], i};
    qsort(sorted, count, sizeof *sorted, compare);
    for (uint32_t i = 0; i < count; i++) {
        if (!i || compare(&sorted[i - 1], &sorted[i]) != 0)
            distinct.points[distinct.count++] = *sorted[i].point;
        distinct.number[sorted[i].index] = distinct.count - 1;
    }
    free(sorted);
    *out = distinct;
    return true;
}

void server_distinct_free(struct server_distinct *distinct)
{
    free(distinct->points);
    *distinct = (struct server_distinct){0};
}
