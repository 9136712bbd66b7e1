/* Edge table: the sides of all faces, grouped by edge. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/pace.h"

/* A side of a face, as an entry in the list of its edge. */
struct gd__edge_use {
    uint32_t high; /* the edge's higher vertex */
    uint32_t side; /* 3 face + k: side k of the face, from corner k to corner k + 1 */
};

/* Compares two sides, for qsort: by `high`, then by side. */
int gd__edge_use_compare(const void *a, const void *b);

struct gd__edge_table {
    uint32_t vertex_count;
    /* for each vertex, index in `use` of the first side with this lower vertex; vertex_count + 1
       entries */
    uint32_t *first;
    /* 3 face_count entries; those of each lower vertex are sorted by higher vertex, then by side */
    struct gd__edge_use *use;
};

/* Groups the sides of `face_count` triangles over `vertex_count` vertices. Linear time, except for
 * sorting each bucket. Errors: GD_NO_MEMORY, and those of the pace. The caller frees the table by
 * gd__edge_table_free, which also accepts a zeroed table. */
enum gd_status gd__edge_table_create(const uint32_t (*corner)[3], uint32_t face_count,
                                     uint32_t vertex_count, struct gd__pace *pace,
                                     struct gd__edge_table *out);

/* Like gd__edge_table_create, but fills the arrays of the caller's table, which are uninitialised.
 * Errors: those of the pace. */
enum gd_status gd__edge_table_fill(const uint32_t (*corner)[3], uint32_t face_count,
                                   struct gd__pace *pace, struct gd__edge_table *table);
void gd__edge_table_free(struct gd__edge_table *table);

/* The sides of one edge. An iteration begins with a zeroed struct. To begin with the edges of a
 * lower vertex v, set `low` = v and `begin` = table->first[v]. */
struct gd__edge_run {
    uint32_t low, high;    /* vertices of the edge */
    uint32_t begin, count; /* the edge's sides are table->use[begin, begin + count) */
};

/* Advances to the next edge, in order of (low, high). Returns false at the end. */
static inline bool gd__edge_table_next(const struct gd__edge_table *table, struct gd__edge_run *run)
{
    uint32_t begin = run->begin + run->count, low = run->low;
    while (low < table->vertex_count && begin == table->first[low + 1]) low++;
    if (low == table->vertex_count) return false;
    uint32_t high = table->use[begin].high, end = begin + 1;
    while (end < table->first[low + 1] && table->use[end].high == high) end++;
    *run = (struct gd__edge_run){low, high, begin, end - begin};
    return true;
}
