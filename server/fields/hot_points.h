/* Recent: which points were asked about often of late, in a fixed room.
 *
 * The counters of Misra and Gries (1982, "Finding repeated elements"): a point that has no counter
 * takes a free one; when none is free it takes one from each of the others instead. So a point that
 * is more than one in SERVER_HOT_POINTS of those asked about has a counter in the end, whatever
 * the others are, and a crowd of different points leaves nothing behind.
 *
 * Points are known by their hash: two that share one are counted together, which does no harm. Not
 * thread-safe. */
#ifndef SERVER_FIELDS_HOT_POINTS_H
#define SERVER_FIELDS_HOT_POINTS_H

#include <stdint.h>

#define SERVER_HOT_POINTS 64

struct server_hot_points { /* all-zero: nothing was asked */
    uint64_t hash[SERVER_HOT_POINTS];
    uint32_t count[SERVER_HOT_POINTS]; /* 0: free */
};

/* Counts one more question about the point. Tens of nanoseconds. */
void server_hot_points_note(struct server_hot_points *hot_points, uint64_t hash);

/* Its questions, of which some may be missing. */
uint32_t server_hot_points_count(const struct server_hot_points *hot_points, uint64_t hash);

/* Frees its counter. */
void server_hot_points_forget(struct server_hot_points *hot_points, uint64_t hash);

#endif
