/* Hot points: the points that were queried most often recently, in fixed memory.
 *
 * The method is that of Misra and Gries (1982, "Finding repeated elements"). A point without a
 * counter gets a free counter. If no counter is free, every counter is decremented. So a point gets
 * a counter if it has more than 1/SERVER_HOT_POINTS of the queries. Points are identified by a
 * hash; a collision is harmless. Not thread-safe. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define SERVER_HOT_POINTS 64

struct server_hot_points { /* all zero is empty */
    uint64_t hash[SERVER_HOT_POINTS];
    uint32_t count[SERVER_HOT_POINTS]; /* 0 if free */
};

/* Returns the point's counter. If the point has no counter, returns a free counter, whose value is
 * 0. If no counter is free, returns NULL. */
static inline uint32_t *server_hot_points_counter(struct server_hot_points *points, uint64_t hash)
{
    uint32_t *vacant = NULL;
    for (uint32_t i = 0; i < SERVER_HOT_POINTS; i++) {
        if (!points->count[i])
            vacant = &points->count[i];
        else if (points->hash[i] == hash)
            return &points->count[i];
    }
    return vacant;
}

/* Counts a query of the point. Cost: tens of nanoseconds. */
static inline void server_hot_points_note(struct server_hot_points *points, uint64_t hash)
{
    uint32_t *counter = server_hot_points_counter(points, hash);
    for (uint32_t i = 0; !counter && i < SERVER_HOT_POINTS; i++) points->count[i]--;
    if (!counter) return;
    points->hash[counter - points->count] = hash;
    ++*counter;
}

/* Returns a lower bound of the number of queries of the point. */
static inline uint32_t server_hot_points_count(struct server_hot_points *points, uint64_t hash)
{
    const uint32_t *counter = server_hot_points_counter(points, hash);
    return counter ? *counter : 0;
}

/* Frees the point's counter. */
static inline void server_hot_points_forget(struct server_hot_points *points, uint64_t hash)
{
    uint32_t *counter = server_hot_points_counter(points, hash);
    if (counter) *counter = 0;
}
