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

struct server_entry *server_entry_create(struct server_mesh_cache *fields,
                                         const struct server_field_key *key, struct gd_field *field)
{
    struct server_budget *budget = fields->cache->budget;
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
    atomic_fetch_add(&fields->references, 1);
    atomic_init(&entry->references, 1);
    entry->cached.field = field;
    entry->fields = fields;
    entry->worth = (struct server_evictable){
        .cost = (double)gd_field_statistics(field)->build_ns, .bytes = bytes + besides, .uses = 1};
    return entry;
}

void server_entry_release(struct server_entry *entry)
{
    if (atomic_fetch_sub(&entry->references, 1) != 1) return;
    server_budget_give(entry->fields->cache->budget, SERVER_BUDGET_FIELDS, entry->worth.bytes);
    gd_field_release(entry->cached.field);
    server_mesh_cache_release(entry->fields);
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

struct server_entry *server_mesh_cache_find(const struct server_mesh_cache *fields,
                                            const struct server_field_key *key)
{
    return entry_of_slot(server_field_table_find(&fields->entries, key));
}

struct server_entry *server_mesh_cache_find_covering(const struct server_mesh_cache *fields,
                                                     const struct server_field_key *key)
{
    struct server_entry *entry = server_mesh_cache_find(fields, key);
    return entry && server_field_key_covers(&entry->slot.key, key) ? entry : NULL;
}

void server_mesh_cache_remove(struct server_entry *entry)
{
    server_field_table_remove(&entry->fields->entries, &entry->slot);
    entry->fields->cache->statistics.fields--;
}

void server_mesh_cache_withdraw(struct server_entry *entry)
{
    server_eviction_remove(&entry->fields->cache->eviction, &entry->worth);
    server_mesh_cache_remove(entry);
}

struct server_entry *server_mesh_cache_put(struct server_entry *entry)
{
    if (!entry || entry->fields->closed ||
        server_mesh_cache_find_covering(entry->fields, &entry->slot.key))
        return NULL;
    struct server_cache *cache = entry->fields->cache;
    if (!server_field_table_reserve(&entry->fields->entries) ||
        !server_eviction_reserve(&cache->eviction))
        return NULL;
    struct server_entry *nearer = server_mesh_cache_find(entry->fields, &entry->slot.key);
    if (nearer) {
        entry->worth.uses += nearer->worth.uses;
        server_mesh_cache_withdraw(nearer);
    }
    atomic_fetch_add(&entry->references, 1);
    server_field_table_insert(&entry->fields->entries, &entry->slot);
    server_eviction_insert(&cache->eviction, &entry->worth);
    cache->statistics.fields++;
    return nearer;
}

/* --- the mesh cache --------------------------------------------------------------------------- */

struct server_mesh_cache *server_mesh_cache_open(struct server_cache *cache)
{
    struct server_mesh_cache *fields = calloc(1, sizeof *fields);
    if (!fields) return NULL;
    fields->references = 1;
    fields->cache = cache;
    return fields;
}

void server_mesh_cache_release(struct server_mesh_cache *fields)
{
    if (atomic_fetch_sub(&fields->references, 1) != 1) return;
    server_field_table_free(&fields->entries);
    free(fields);
}

void server_mesh_cache_close(struct server_mesh_cache *fields)
{
    struct server_cache *cache = fields->cache;
    struct server_entry *removed = NULL;
    pthread_mutex_lock(&cache->lock);
    fields->closed = true;
    for (uint32_t i = 0; i < fields->entries.bucket_count; i++) {
        while (fields->entries.buckets[i]) {
            struct server_entry *entry = entry_of_slot(fields->entries.buckets[i]);
            server_mesh_cache_withdraw(entry);
            entry->next = removed;
            removed = entry;
        }
    }
    pthread_mutex_unlock(&cache->lock);
    server_entries_release(removed);
}

static uint32_t pin_points(struct server_mesh_cache *fields, const struct server_cached **pinned)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < fields->entries.bucket_count; i++) {
        for (struct server_field_slot *slot = fields->entries.buckets[i]; slot; slot = slot->next) {
            struct server_entry *entry = entry_of_slot(slot);
            if (!server_field_key_is_point(&slot->key)) continue;
            atomic_fetch_add(&entry->references, 1);
            pinned[count++] = &entry->cached;
        }
    }
    return count;
}

const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count)
{
    pthread_mutex_lock(&fields->cache->lock);
    const struct server_cached **pinned =
        fields->entries.count ? malloc(fields->entries.count * sizeof(struct server_cached *))
                              : NULL;
    *count = pinned ? pin_points(fields, pinned) : 0;
    pthread_mutex_unlock(&fields->cache->lock);
    return pinned;
}

uint32_t server_mesh_cache_count(struct server_mesh_cache *fields)
{
    pthread_mutex_lock(&fields->cache->lock);
    uint32_t count = fields->entries.count;
    pthread_mutex_unlock(&fields->cache->lock);
    return count;
}
