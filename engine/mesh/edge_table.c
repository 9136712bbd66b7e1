/* Sorts the sides into buckets by their lower vertex, and each bucket by the higher vertex. */
#include "base/large.h"
#include "base/slices.h"
#include "mesh/edge_table.h"

#include <stdlib.h>
#include <string.h>

static void ends_of_side(const uint32_t (*corner)[3], uint32_t side, uint32_t *low, uint32_t *high)
{
    uint32_t a = corner[side / 3][side % 3], b = corner[side / 3][side % 3 == 2 ? 0 : side % 3 + 1];
    *low = a < b ? a : b;
    *high = a < b ? b : a;
}

int gd__edge_use_compare(const void *x, const void *y)
{
    const struct gd__edge_use *a = x, *b = y;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->side < b->side ? -1 : a->side > b->side;
}

#define SHORT_BUCKET 32

static void sort_bucket(struct gd__edge_use *use, uint32_t count)
{
    if (count > SHORT_BUCKET) {
        qsort(use, count, sizeof *use, gd__edge_use_compare);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        struct gd__edge_use moved = use[i];
        uint32_t j = i;
        for (; j > 0 && gd__edge_use_compare(&moved, &use[j - 1]) < 0; j--) use[j] = use[j - 1];
        use[j] = moved;
    }
}

static void sort_buckets(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct gd__edge_table *table = context;
    (void)pace;
    for (uint32_t v = begin; v < end; v++)
        sort_bucket(table->use + table->first[v], table->first[v + 1] - table->first[v]);
}

enum gd_status gd__edge_table_fill(const uint32_t (*corner)[3], uint32_t face_count,
                                   struct gd__pace *pace, struct gd__edge_table *table)
{
    uint32_t vertex_count = table->vertex_count, side_count = 3 * face_count, low, high;
    memset(table->first, 0, ((size_t)vertex_count + 1) * sizeof *table->first);
    GD__PACED (pace, s, side_count) {
        ends_of_side(corner, s, &low, &high);
        table->first[low + 1]++;
    }
    GD__PACED (pace, v, vertex_count) table->first[v + 1] += table->first[v];
    gd__slices_touch(pace, table->use, side_count * sizeof *table->use);
    GD__PACED (pace, s, side_count) {
        ends_of_side(corner, s, &low, &high);
        table->use[table->first[low]++] = (struct gd__edge_use){high, s};
    }
    GD__PACED (pace, moved, vertex_count) {
        uint32_t v = vertex_count - moved;
        table->first[v] = table->first[v - 1];
    }
    table->first[0] = 0;
    gd__slices_run(pace, vertex_count, sort_buckets, table);
    return pace->status;
}

enum gd_status gd__edge_table_create(const uint32_t (*corner)[3], uint32_t face_count,
                                     uint32_t vertex_count, struct gd__pace *pace,
                                     struct gd__edge_table *out)
{
    struct gd__edge_table table = {vertex_count,
                                   gd__large_array((size_t)vertex_count + 1, sizeof *table.first),
                                   gd__large_array(3 * (size_t)face_count + 1, sizeof *table.use)};
    enum gd_status status = table.first && table.use ? GD_OK : GD_NO_MEMORY;
    if (!status) status = gd__edge_table_fill(corner, face_count, pace, &table);
    if (status)
        gd__edge_table_free(&table);
    else
        *out = table;
    return status;
}

void gd__edge_table_free(struct gd__edge_table *table)
{
    free(table->first);
    free(table->use);
    *table = (struct gd__edge_table){0};
}
