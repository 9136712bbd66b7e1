/* See recent.h. */
#include "server/fields/hot_points.h"

/* Index of the point's counter, else of a free one, else SERVER_RECENT_POINTS. */
static uint32_t find(const struct server_recent *recent, uint64_t hash)
{
    uint32_t vacant = SERVER_RECENT_POINTS;
    for (uint32_t i = 0; i < SERVER_RECENT_POINTS; i++) {
        if (!recent->count[i])
            vacant = i;
        else if (recent->hash[i] == hash)
            return i;
    }
    return vacant;
}

void server_recent_note(struct server_recent *recent, uint64_t hash)
{
    uint32_t at = find(recent, hash);
    if (at < SERVER_RECENT_POINTS) {
        recent->hash[at] = hash;
        recent->count[at]++;
        return;
    }
    for (uint32_t i = 0; i < SERVER_RECENT_POINTS; i++) recent->count[i]--;
}

uint32_t server_recent_count(const struct server_recent *recent, uint64_t hash)
{
    uint32_t at = find(recent, hash);
    return at < SERVER_RECENT_POINTS && recent->hash[at] == hash ? recent->count[at] : 0;
}

void server_recent_forget(struct server_recent *recent, uint64_t hash)
{
    uint32_t at = find(recent, hash);
    if (at < SERVER_RECENT_POINTS && recent->hash[at] == hash) recent->count[at] = 0;
}
