/* Sorted array of pointers to items; each item has its own key. Not thread-safe. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct server_sorted { /* an empty array is all zero, except for `compare` */
    void **items;      /* freed by free() */
    uint32_t count, capacity;
    int (*compare)(const void *item, const void *key); /* the result is like that of strcmp */
};

/* Returns the index of the first item whose key is not below `key`. O(log n). */
static inline uint32_t server_sorted_index(const struct server_sorted *sorted, const void *key)
{
    uint32_t low = 0, high = sorted->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (sorted->compare(sorted->items[middle], key) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Returns the item of that key, or NULL. */
static inline void *server_sorted_find(const struct server_sorted *sorted, const void *key)
{
    uint32_t at = server_sorted_index(sorted, key);
    bool is_found = at < sorted->count && sorted->compare(sorted->items[at], key) == 0;
    return is_found ? sorted->items[at] : NULL;
}

/* Returns the index of the first item whose key is above `key`. */
static inline uint32_t server_sorted_after(const struct server_sorted *sorted, const void *key)
{
    return server_sorted_index(sorted, key) + (server_sorted_find(sorted, key) != NULL);
}

/* Makes room for one more item. Returns false if out of memory. */
static inline bool server_sorted_reserve(struct server_sorted *sorted)
{
    if (sorted->count < sorted->capacity) return true;
    uint32_t capacity = sorted->capacity ? 2 * sorted->capacity : 16;
    void **items = realloc(sorted->items, capacity * sizeof *items);
    if (!items) return false;
    sorted->items = items;
    sorted->capacity = capacity;
    return true;
}

/* Inserts an item at the index of its key. The caller has reserved room. */
static inline void server_sorted_insert(struct server_sorted *sorted, uint32_t at, void *item)
{
    void **place = &sorted->items[at];
    memmove(place + 1, place, (sorted->count++ - at) * sizeof *place);
    *place = item;
}

/* Removes the item at an index and returns it. */
static inline void *server_sorted_remove(struct server_sorted *sorted, uint32_t at)
{
    void **place = &sorted->items[at], *item = *place;
    memmove(place, place + 1, (--sorted->count - at) * sizeof *place);
    return item;
}
