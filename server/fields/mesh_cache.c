/* See cache.h and cache_parts.h. */
#include <stdlib.h>

#include "server/fields/cache_parts.h"

/* --- entries ---------------------------------------------------------------------------------- */

static struct server_entry *allocate_entry(const struct server_field_key *key)
{
    struct server_entry *entry = calloc(1, sizeof *entry);
    if (entry && server_field_key_copy(key, &entry->slot.key)) return entry;
    free(entry);
    return NULL;
}

struct server_entry *server_entry_create(struct server_shelf *shelf,
                                         const struct server_field_key *key, struct gd_field *field)
{
    struct server_budget *budget = shelf->cache->budget;
    size_t bytes = gd_field_memsize(field),
           besides = sizeof(struct server_entry) + key->seed_count * sizeof *key->seeds;
    struct server_entry *entry = allocate_entry(key);
    if (!entry) {
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        gd_field_release(field);
        return NULL;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_FIELDS, bytes);
    server_budget_adjust(budget, SERVER_BUDGET_FIELDS, bytes, bytes + besides);
    atomic_fetch_add(&shelf->references, 1);
    atomic_init(&entry->references, 1);
    entry->cached.field = field;
    entry->shelf = shelf;
    entry->worth = (struct server_evictable){
        .cost = (double)gd_field_statistics(field)->build_ns, .bytes = bytes + besides, .uses = 1};
    return entry;
}

void server_entry_release(struct server_entry *entry)
{
    if (atomic_fetch_sub(&entry->references, 1) != 1) return;
    server_budget_give(entry->shelf->cache->budget, SERVER_BUDGET_FIELDS, entry->worth.bytes);
    gd_field_release(entry->cached.field);
    server_shelf_release(entry->shelf);
    server_field_key_free(&entry->slot.key);
    free(entry);
}

void server_entries_release(struct server_entry *entry)
{
    while (entry) {
        struct server_entry *next = entry->next;
        server_entry_release(entry);
        entry = next;
    }
}

/* --- under the lock --------------------------------------------------------------------------- */

static struct server_entry *entry_of_slot(struct server_field_slot *slot)
{
    return slot ? (struct server_entry *)((char *)slot - offsetof(struct server_entry, slot))
                : NULL;
}

struct server_entry *server_shelf_find(const struct server_shelf *shelf,
                                       const struct server_field_key *key)
{
    return entry_of_slot(server_field_table_find(&shelf->entries, key));
}

struct server_entry *server_shelf_find_covering(const struct server_shelf *shelf,
                                                const struct server_field_key *key)
{
    struct server_entry *entry = server_shelf_find(shelf, key);
    return entry && server_field_key_covers(&entry->slot.key, key) ? entry : NULL;
}

void server_shelf_remove(struct server_entry *entry)
{
    server_field_table_remove(&entry->shelf->entries, &entry->slot);
    entry->shelf->cache->statistics.fields--;
}

void server_shelf_withdraw(struct server_entry *entry)
{
    server_eviction_remove(&entry->shelf->cache->eviction, &entry->worth);
    server_shelf_remove(entry);
}

struct server_entry *server_shelf_put(struct server_entry *entry)
{
    if (!entry || entry->shelf->closed ||
        server_shelf_find_covering(entry->shelf, &entry->slot.key))
        return NULL;
    struct server_cache *cache = entry->shelf->cache;
    if (!server_field_table_reserve(&entry->shelf->entries) ||
        !server_eviction_reserve(&cache->eviction))
        return NULL;
    struct server_entry *nearer = server_shelf_find(entry->shelf, &entry->slot.key);
    if (nearer) {
        entry->worth.uses += nearer->worth.uses;
        server_shelf_withdraw(nearer);
    }
    atomic_fetch_add(&entry->references, 1);
    server_field_table_insert(&entry->shelf->entries, &entry->slot);
    server_eviction_insert(&cache->eviction, &entry->worth);
    cache->statistics.fields++;
    return nearer;
}

/* --- the shelf -------------------------------------------------------------------------------- */

struct server_shelf *server_shelf_open(struct server_cache *cache)
{
    struct server_shelf *shelf = calloc(1, sizeof *shelf);
    if (!shelf) return NULL;
    shelf->references = 1;
    shelf->cache = cache;
    return shelf;
}

void server_shelf_release(struct server_shelf *shelf)
{
    if (atomic_fetch_sub(&shelf->references, 1) != 1) return;
    server_field_table_free(&shelf->entries);
    free(shelf);
}

void server_shelf_close(struct server_shelf *shelf)
{
    struct server_cache *cache = shelf->cache;
    struct server_entry *removed = NULL;
    pthread_mutex_lock(&cache->lock);
    shelf->closed = true;
    for (uint32_t i = 0; i < shelf->entries.bucket_count; i++) {
        while (shelf->entries.buckets[i]) {
            struct server_entry *entry = entry_of_slot(shelf->entries.buckets[i]);
            server_shelf_withdraw(entry);
            entry->next = removed;
            removed = entry;
        }
    }
    pthread_mutex_unlock(&cache->lock);
    server_entries_release(removed);
}

static uint32_t pin_points(struct server_shelf *shelf, const struct server_cached **pinned)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < shelf->entries.bucket_count; i++) {
        for (struct server_field_slot *slot = shelf->entries.buckets[i]; slot; slot = slot->next) {
            struct server_entry *entry = entry_of_slot(slot);
            if (!server_field_key_is_point(&slot->key)) continue;
            atomic_fetch_add(&entry->references, 1);
            pinned[count++] = &entry->cached;
        }
    }
    return count;
}

const struct server_cached **server_shelf_pin_points(struct server_shelf *shelf, uint32_t *count)
{
    pthread_mutex_lock(&shelf->cache->lock);
    const struct server_cached **pinned =
        shelf->entries.count ? malloc(shelf->entries.count * sizeof(struct server_cached *)) : NULL;
    *count = pinned ? pin_points(shelf, pinned) : 0;
    pthread_mutex_unlock(&shelf->cache->lock);
    return pinned;
}

uint32_t server_shelf_count(struct server_shelf *shelf)
{
    pthread_mutex_lock(&shelf->cache->lock);
    uint32_t count = shelf->entries.count;
    pthread_mutex_unlock(&shelf->cache->lock);
    return count;
}
