/* See registry.h. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/surfaces/registry_slots.h"

/* --- memory ----------------------------------------------------------------------------------- */

static bool can_unload(const struct server_surface *surface)
{
    return surface && atomic_load(&surface->references) == 1;
}

/* Bytes of the surfaces that could be unloaded at this moment. */
static size_t unloadable(void *user)
{
    struct server_registry *registry = user;
    size_t bytes = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count; i++)
        if (can_unload(registry->slots[i]->surface)) bytes += registry->slots[i]->surface->bytes;
    pthread_rwlock_unlock(&registry->lock);
    return bytes;
}

/* Under the lock: the least recently used that can be unloaded. */
static struct server_slot *coldest(const struct server_registry *registry, bool without_fields)
{
    struct server_slot *coldest = NULL;
    for (uint32_t i = 0; i < registry->count; i++) {
        struct server_slot *slot = registry->slots[i];
        if (!can_unload(slot->surface) || (coldest && slot->turn >= coldest->turn)) continue;
        if (without_fields && server_mesh_cache_count(slot->surface->fields)) continue;
        coldest = slot;
    }
    return coldest;
}

/* Takes the coldest surface out of memory; its bytes, or 0 when there is none. */
static size_t unload_one(struct server_registry *registry, bool without_fields)
{
    pthread_rwlock_wrlock(&registry->lock);
    struct server_slot *slot = coldest(registry, without_fields);
    struct server_surface *surface = slot ? slot->surface : NULL;
    if (slot) slot->surface = NULL;
    pthread_rwlock_unlock(&registry->lock);
    if (!surface) return 0;
    size_t bytes = surface->bytes;
    server_slot_retire(surface);
    atomic_fetch_add(&registry->unloads, 1);
    return bytes;
}

static void unload(struct server_registry *registry, size_t bytes, bool without_fields)
{
    for (size_t freed = 0, one; freed < bytes; freed += one) {
        one = unload_one(registry, without_fields);
        if (!one) return;
    }
}

static void unload_idle(void *user, size_t bytes)
{
    unload(user, bytes, true);
}

static void unload_any(void *user, size_t bytes)
{
    unload(user, bytes, false);
}

/* --- life ------------------------------------------------------------------------------------- */

static bool on_stored(void *user, const struct server_stored *stored)
{
    struct server_registry *registry = user;
    if (server_slots_append(registry, stored)) return true;
    registry->is_incomplete = true;
    return false;
}

struct server_registry *server_registry_create(struct server_store *store,
                                               struct server_budget *budget)
{
    struct server_registry *registry = calloc(1, sizeof *registry);
    if (!registry) {
        store->close(store);
        return NULL;
    }
    registry->store = store;
    registry->budget = budget;
    registry->writer = server_workers_create(1, UINT32_MAX);
    registry->reader = server_workers_create(1, UINT32_MAX);
    pthread_mutex_init(&registry->writing, NULL);
    pthread_mutex_init(&registry->following, NULL);
    pthread_rwlock_init(&registry->lock, NULL);
    registry->is_incomplete =
        store->each(store, on_stored, registry) != SERVER_STORE_DONE || registry->is_incomplete;
    server_slots_sort(registry);
    if (registry->is_incomplete || !registry->writer || !registry->reader ||
        !server_slots_start_follower(registry)) {
        server_registry_destroy(registry);
        return NULL;
    }
    if (!store->fetch) return registry; /* what is unloaded would be lost */
    budget->reclaimers[SERVER_RECLAIM_IDLE] =
        (struct server_reclaimer){unload_idle, NULL, registry};
    budget->reclaimers[SERVER_RECLAIM_MESHES] =
        (struct server_reclaimer){unload_any, unloadable, registry};
    return registry;
}

void server_registry_destroy(struct server_registry *registry)
{
    if (!registry) return;
    server_slots_stop_follower(registry);
    server_workers_destroy(registry->writer);
    server_workers_destroy(registry->reader);
    registry->budget->reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){0};
    registry->budget->reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){0};
    for (uint32_t i = 0; i < registry->count; i++) server_slot_destroy(registry->slots[i]);
    registry->store->close(registry->store);
    pthread_rwlock_destroy(&registry->lock);
    pthread_mutex_destroy(&registry->following);
    pthread_mutex_destroy(&registry->writing);
    free(registry->slots);
    free(registry);
}

/* --- reading ---------------------------------------------------------------------------------- */

void server_listed_release(struct server_listed *listed)
{
    server_surface_release(listed->surface);
    server_record_release(listed->record);
}

bool server_registry_holds(struct server_registry *registry, const char *etag)
{
    bool found = false;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count && !found; i++)
        found = strcmp(registry->slots[i]->record->etag, etag) == 0;
    pthread_rwlock_unlock(&registry->lock);
    return found;
}

static struct server_listed share(const struct server_slot *slot)
{
    return (struct server_listed){server_record_retain(slot->record),
                                  slot->surface ? server_surface_retain(slot->surface) : NULL};
}

bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct server_slot *slot = server_slots_find(registry, key);
    if (slot) *out = share(slot);
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record)
{
    const struct server_key key = server_record_key(record);
    (void)server_registry_follow(registry, gd_now_ns());
    pthread_rwlock_rdlock(&registry->lock);
    const struct server_slot *slot = server_slots_find(registry, &key);
    bool is_current = slot && slot->record == record;
    pthread_rwlock_unlock(&registry->lock);
    return is_current;
}

bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct server_slot *slot = server_slots_find(registry, key);
    if (slot) {
        server_slot_touch(registry, slot);
        *out = slot->surface ? server_surface_retain(slot->surface) : NULL;
    }
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

/* Under the lock: index of the first slot that follows the key. */
static uint32_t place_after(const struct server_registry *registry, const struct server_key *key)
{
    uint32_t at = server_slots_lower_bound(registry, key);
    return server_slots_find(registry, key) ? at + 1 : at;
}

static bool is_beside(const struct server_record *record, const struct server_key *key)
{
    return record->kind == key->kind && strcmp(record->tenant, key->tenant) == 0;
}

uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              uint32_t most, struct server_listed *out)
{
    const struct server_key from = {after->tenant, after->kind, after->name ? after->name : ""};
    uint32_t listed = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t at = place_after(registry, &from); listed < most && at < registry->count; at++) {
        if (!is_beside(registry->slots[at]->record, &from)) break;
        out[listed++] = share(registry->slots[at]);
    }
    pthread_rwlock_unlock(&registry->lock);
    return listed;
}

uint32_t server_registry_list_all(struct server_registry *registry, const struct server_key *after,
                                  uint32_t most, struct server_listed *out)
{
    uint32_t listed = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t at = after ? place_after(registry, after) : 0;
         listed < most && at < registry->count; at++)
        out[listed++] = share(registry->slots[at]);
    pthread_rwlock_unlock(&registry->lock);
    return listed;
}

struct server_registry_statistics server_registry_statistics(struct server_registry *registry)
{
    struct server_registry_statistics statistics = {.loads = registry->loads,
                                                    .unloads = registry->unloads};
    if (registry->store->damaged) statistics.damaged = registry->store->damaged(registry->store);
    pthread_rwlock_rdlock(&registry->lock);
    statistics.surfaces = registry->count;
    for (uint32_t i = 0; i < registry->count; i++)
        statistics.loaded += registry->slots[i]->surface != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return statistics;
}

const char *server_registry_health(struct server_registry *registry)
{
    return registry->store->health(registry->store);
}

/* --- loading ---------------------------------------------------------------------------------- */

enum server_store_outcome server_registry_fetch(struct server_registry *registry,
                                                const struct server_record *record,
                                                enum server_part part, void **bytes)
{
    return registry->store->fetch(registry->store, record, part, bytes);
}

bool server_registry_can_verify(const struct server_registry *registry)
{
    return registry->store->verify != NULL;
}

enum server_store_verdict server_registry_verify(struct server_registry *registry,
                                                 const struct server_record *record,
                                                 enum server_part part,
                                                 bool (*pace)(void *user, size_t bytes), void *user)
{
    return registry->store->verify(registry->store, record, part, pace, user);
}

void server_registry_keep(struct server_registry *registry, struct server_surface *surface)
{
    const struct server_key key = server_record_key(surface->record);
    pthread_rwlock_wrlock(&registry->lock);
    struct server_slot *slot = server_slots_find(registry, &key);
    if (slot && slot->record == surface->record && !slot->surface) {
        slot->surface = server_surface_retain(surface);
        atomic_fetch_add(&registry->loads, 1);
    }
    pthread_rwlock_unlock(&registry->lock);
}

/* Was `a` used more than `b`? Of equals, the later one. */
static bool is_hotter(const struct server_slot *a, const struct server_slot *b)
{
    return a->uses != b->uses ? a->uses > b->uses : a->last > b->last;
}

struct server_record *server_registry_hottest(struct server_registry *registry)
{
    const struct server_slot *hottest = NULL;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count; i++) {
        const struct server_slot *slot = registry->slots[i];
        if (!slot->surface && !slot->was_tried && (!hottest || is_hotter(slot, hottest)))
            hottest = slot;
    }
    if (hottest) atomic_store(&((struct server_slot *)hottest)->was_tried, true);
    struct server_record *record = hottest ? server_record_retain(hottest->record) : NULL;
    pthread_rwlock_unlock(&registry->lock);
    return record;
}
