/* See registry_slots.h. */
#include "server/surfaces/registry_slots.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static int compare(const struct server_slot *slot, const struct server_key *key)
{
    const struct server_key own = server_record_key(slot->record);
    return server_key_compare(&own, key);
}

uint32_t server_slots_lower_bound(const struct server_registry *registry,
                                  const struct server_key *key)
{
    uint32_t low = 0, high = registry->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (compare(registry->slots[middle], key) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct server_slot *server_slots_find(const struct server_registry *registry,
                                      const struct server_key *key)
{
    uint32_t at = server_slots_lower_bound(registry, key);
    if (at == registry->count || compare(registry->slots[at], key) != 0) return NULL;
    return registry->slots[at];
}

static int by_key(const void *a, const void *b)
{
    const struct server_slot *const *first = a, *const *second = b;
    const struct server_key key = server_record_key((*second)->record);
    return compare(*first, &key);
}

void server_slots_sort(struct server_registry *registry)
{
    if (registry->count)
        qsort(registry->slots, registry->count, sizeof(struct server_slot *), by_key);
}

bool server_slots_reserve(struct server_registry *registry)
{
    if (registry->count < registry->capacity) return true;
    uint32_t capacity = registry->capacity ? 2 * registry->capacity : 16;
    struct server_slot **slots = realloc(registry->slots, capacity * sizeof(struct server_slot *));
    if (!slots) return false;
    registry->slots = slots;
    registry->capacity = capacity;
    return true;
}

struct server_slot *server_slot_create(struct server_record *record)
{
    struct server_slot *slot = calloc(1, sizeof *slot);
    if (slot) slot->record = server_record_retain(record);
    return slot;
}

bool server_slots_append(struct server_registry *registry, const struct server_stored *stored)
{
    struct server_slot *slot =
        server_slots_reserve(registry) ? server_slot_create(stored->record) : NULL;
    if (!slot) return false;
    server_record_count(stored->record, registry->budget);
    slot->uses = slot->noted = stored->uses.count;
    slot->last = stored->uses.last;
    slot->version = stored->version;
    registry->slots[registry->count++] = slot;
    return true;
}

void server_slots_insert(struct server_registry *registry, struct server_slot *slot)
{
    const struct server_key key = server_record_key(slot->record);
    uint32_t at = server_slots_lower_bound(registry, &key);
    memmove(&registry->slots[at + 1], &registry->slots[at],
            (registry->count - at) * sizeof(struct server_slot *));
    registry->slots[at] = slot;
    registry->count++;
}

struct server_slot *server_slots_extract(struct server_registry *registry,
                                         const struct server_key *key)
{
    uint32_t at = server_slots_lower_bound(registry, key);
    struct server_slot *slot = registry->slots[at];
    registry->count--;
    memmove(&registry->slots[at], &registry->slots[at + 1],
            (registry->count - at) * sizeof(struct server_slot *));
    return slot;
}

void server_slot_touch(struct server_registry *registry, struct server_slot *slot)
{
    atomic_store_explicit(&slot->turn,
                          atomic_fetch_add_explicit(&registry->clock, 1, memory_order_relaxed),
                          memory_order_relaxed);
    atomic_fetch_add_explicit(&slot->uses, 1, memory_order_relaxed);
    atomic_store_explicit(&slot->last, time(NULL), memory_order_relaxed);
}

void server_slots_tell(struct server_registry *registry, const struct server_record *record)
{
    if (registry->gone && !server_registry_holds(registry, record->etag))
        registry->gone(registry->gone_user, record);
}

void server_slot_retire(struct server_surface *surface)
{
    if (!surface) return;
    server_surface_retire(surface);
    server_surface_release(surface);
}

void server_slot_destroy(struct server_slot *slot)
{
    if (!slot) return;
    server_slot_retire(slot->surface);
    server_record_release(slot->record);
    free(slot);
}
