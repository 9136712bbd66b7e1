/* Hot points: the points that were asked about most often of late, in fixed memory.
 *
 * The counters of Misra and Gries (1982, "Finding repeated elements"): a point without a counter
 * gets a free one; when none is free, every counter is decremented instead. So a point that is more
 * than one in SERVER_HOT_POINTS of the questions ends up with a counter, and a crowd of different
 * points leaves none.
 *
 * Points are identified by a hash; a collision counts two points together, which is harmless. Not
 * thread-safe. */
#ifndef SERVER_FIELDS_HOT_POINTS_H
#define SERVER_FIELDS_HOT_POINTS_H

#include <stdint.h>

#define SERVER_HOT_POINTS 64

struct server_hot_points { /* all zero is empty */
    uint64_t hash[SERVER_HOT_POINTS];
    uint32_t count[SERVER_HOT_POINTS]; /* 0: free */
};

/* Counts one more question about the point. Tens of nanoseconds. */
void server_hot_points_note(struct server_hot_points *points, uint64_t hash);

/* The point's questions, or fewer. */
uint32_t server_hot_points_count(const struct server_hot_points *points, uint64_t hash);

/* Frees the point's counter. */
void server_hot_points_forget(struct server_hot_points *points, uint64_t hash);

#endif
