/* See hot_points.h. */
#include "server/fields/hot_points.h"

/* Index of the point's counter, else of a free one, else SERVER_HOT_POINTS. */
static uint32_t find(const struct server_hot_points *hot_points, uint64_t hash)
{
    uint32_t vacant = SERVER_HOT_POINTS;
    for (uint32_t i = 0; i < SERVER_HOT_POINTS; i++) {
        if (!hot_points->count[i])
            vacant = i;
        else if (hot_points->hash[i] == hash)
            return i;
    }
    return vacant;
}

void server_hot_points_note(struct server_hot_points *hot_points, uint64_t hash)
{
    uint32_t at = find(hot_points, hash);
    if (at < SERVER_HOT_POINTS) {
        hot_points->hash[at] = hash;
        hot_points->count[at]++;
        return;
    }
    for (uint32_t i = 0; i < SERVER_HOT_POINTS; i++) hot_points->count[i]--;
}

uint32_t server_hot_points_count(const struct server_hot_points *hot_points, uint64_t hash)
{
    uint32_t at = find(hot_points, hash);
    return at < SERVER_HOT_POINTS && hot_points->hash[at] == hash ? hot_points->count[at] : 0;
}

void server_hot_points_forget(struct server_hot_points *hot_points, uint64_t hash)
{
    uint32_t at = find(hot_points, hash);
    if (at < SERVER_HOT_POINTS && hot_points->hash[at] == hash) hot_points->count[at] = 0;
}
