/* See hot_points.h. */
#include "server/fields/hot_points.h"

/* Index of the point's counter, else of a free one, else SERVER_HOT_POINTS. */
static uint32_t counter_find(const struct server_hot_points *points, uint64_t hash)
{
    uint32_t vacant = SERVER_HOT_POINTS;
    for (uint32_t i = 0; i < SERVER_HOT_POINTS; i++) {
        if (!points->count[i])
            vacant = i;
        else if (points->hash[i] == hash)
            return i;
    }
    return vacant;
}

void server_hot_points_note(struct server_hot_points *points, uint64_t hash)
{
    uint32_t at = counter_find(points, hash);
    if (at < SERVER_HOT_POINTS) {
        points->hash[at] = hash;
        points->count[at]++;
        return;
    }
    for (uint32_t i = 0; i < SERVER_HOT_POINTS; i++) points->count[i]--;
}

uint32_t server_hot_points_count(const struct server_hot_points *points, uint64_t hash)
{
    uint32_t at = counter_find(points, hash);
    return at < SERVER_HOT_POINTS && points->hash[at] == hash ? points->count[at] : 0;
}

void server_hot_points_forget(struct server_hot_points *points, uint64_t hash)
{
    uint32_t at = counter_find(points, hash);
    if (at < SERVER_HOT_POINTS && points->hash[at] == hash) points->count[at] = 0;
}
