/* Dynamic programming over the intervals of the ring (G. Klincsek, "Minimal triangulations of
 * polygonal domains", 1980). */
#include "construction/interval.h"

struct ring {
    /* the corners in the order of the ring */
    const struct gd__ring_corner *corner[GD_INTERVAL_MAX_CORNERS];
    uint32_t count;
    const struct gd__edge_set *edges;
};

/* Returns the cost of a triangle. A flipped triangle costs more than any number of triangles with a
 * bad shape. */
static double interval_cost_of(const struct ring *ring, uint32_t i, uint32_t k, uint32_t j)
{
    const struct gd__ring_corner *a = ring->corner[i], *b = ring->corner[k], *c = ring->corner[j];
    return 1 - gd__ring_shape(a, b, c) + (gd__ring_turn(a, b, c) > 0 ? 0 : GD_INTERVAL_MAX_CORNERS);
}

static void solve_interval(struct gd__interval_table *table, const struct ring *ring, uint32_t i,
                           uint32_t j)
{
    bool is_side = i == 0 && j + 1 == ring->count;
    table->cost[i][j] = INFINITY;
    if (!is_side && !gd__ring_may_join(ring->edges, ring->corner[i], ring->corner[j])) return;
    for (uint32_t k = i + 1; k < j; k++) {
        double cost = table->cost[i][k] + table->cost[k][j];
        if (cost < INFINITY) cost += interval_cost_of(ring, i, k, j);
        if (cost >= table->cost[i][j]) continue;
        table->cost[i][j] = cost;
        table->apex[i][j] = (uint8_t)k;
    }
}

/* Writes the triangles of the whole ring. A stack contains the intervals that must still be
 * divided. */
static void interval_emit(const struct gd__interval_table *table, const struct ring *ring,
                          uint32_t (*triangle)[3])
{
    uint32_t waiting[GD_INTERVAL_MAX_CORNERS][2] = {{0, ring->count - 1}}, count = 1;
    while (count) {
        count--;
        uint32_t i = waiting[count][0], j = waiting[count][1], k = table->apex[i][j];
        (*triangle)[0] = ring->corner[i]->vertex;
        (*triangle)[1] = ring->corner[k]->vertex;
        (*triangle++)[2] = ring->corner[j]->vertex;
        for (int half = 0; half < 2; half++) {
            uint32_t from = half ? k : i, to = half ? j : k;
            if (to - from < 2) continue;
            waiting[count][0] = from;
            waiting[count++][1] = to;
        }
    }
}

bool gd__interval_cut(struct gd__interval_table *table, const struct gd__ring_corner *corner,
                      uint32_t first, uint32_t count, const struct gd__edge_set *edges,
                      uint32_t (*triangle)[3])
{
    struct ring ring = {.count = count, .edges = edges};
    for (uint32_t i = 0, at = first; i < count; i++, at = corner[at].next)
        ring.corner[i] = &corner[at];
    for (uint32_t i = 0; i + 1 < count; i++) table->cost[i][i + 1] = 0;
    for (uint32_t span = 2; span < count; span++) {
        for (uint32_t i = 0; i + span < count; i++) solve_interval(table, &ring, i, i + span);
    }
    if (table->cost[0][count - 1] == INFINITY) return false;
    interval_emit(table, &ring, triangle);
    return true;
}
