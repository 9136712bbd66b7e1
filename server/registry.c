/* See registry.h. */
#include "server/registry.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct slot {
    struct server_record *record;
    struct server_surface *surface; /* NULL: not in memory */
    atomic_uint_least64_t uses;
    atomic_int_least64_t last;  /* seconds since 1970 */
    atomic_uint_least64_t turn; /* of the registry's clock, when it was used last */
    uint64_t noted;             /* uses that the store knows; under the writer lock */
    atomic_bool was_tried;      /* to be loaded before anybody asked */
};

struct server_registry {
    struct server_store *store;
    struct server_budget *budget;
    pthread_mutex_t writing;
    pthread_rwlock_t lock;
    struct slot **slots; /* sorted by name */
    uint32_t count, capacity;
    void (*gone)(void *user, const struct server_record *record); /* NULL: nobody wants to know */
    void *gone_user;
    bool is_incomplete; /* the store has more than memory could be had for */
    atomic_uint_least64_t clock, loads, unloads;
};

/* --- slots, under the lock ---------------------------------------------------------------------------------------- */

/* Index of the first slot whose name is not before `name`. */
static uint32_t lower_bound(const struct server_registry *registry, const char *name)
{
    uint32_t low = 0, high = registry->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(registry->slots[middle]->record->name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static struct slot *find(const struct server_registry *registry, const char *name)
{
    uint32_t at = lower_bound(registry, name);
    if (at == registry->count || strcmp(registry->slots[at]->record->name, name) != 0) return NULL;
    return registry->slots[at];
}

static bool reserve(struct server_registry *registry)
{
    if (registry->count < registry->capacity) return true;
    uint32_t capacity = registry->capacity ? 2 * registry->capacity : 16;
    struct slot **slots = realloc(registry->slots, capacity * sizeof(struct slot *));
    if (!slots) return false;
    registry->slots = slots;
    registry->capacity = capacity;
    return true;
}

/* A slot that stands nowhere as yet. */
static struct slot *create_slot(struct server_record *record)
{
    struct slot *slot = calloc(1, sizeof *slot);
    if (slot) slot->record = server_record_retain(record);
    return slot;
}

/* Room was reserved. */
static void insert(struct server_registry *registry, struct slot *slot)
{
    uint32_t at = lower_bound(registry, slot->record->name);
    memmove(&registry->slots[at + 1], &registry->slots[at], (registry->count - at) * sizeof(struct slot *));
    registry->slots[at] = slot;
    registry->count++;
}

static struct slot *extract(struct server_registry *registry, const char *name)
{
    uint32_t at = lower_bound(registry, name);
    struct slot *slot = registry->slots[at];
    registry->count--;
    memmove(&registry->slots[at], &registry->slots[at + 1], (registry->count - at) * sizeof(struct slot *));
    return slot;
}

static void touch(struct server_registry *registry, struct slot *slot)
{
    atomic_store_explicit(&slot->turn, atomic_fetch_add_explicit(&registry->clock, 1, memory_order_relaxed),
                          memory_order_relaxed);
    atomic_fetch_add_explicit(&slot->uses, 1, memory_order_relaxed);
    atomic_store_explicit(&slot->last, time(NULL), memory_order_relaxed);
}

/* --- not under the lock ------------------------------------------------------------------------------------------- */

static void retire(struct server_surface *surface)
{
    if (!surface) return;
    server_surface_retire(surface);
    server_surface_release(surface);
}

static void destroy_slot(struct slot *slot)
{
    if (!slot) return;
    retire(slot->surface);
    server_record_release(slot->record);
    free(slot);
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

static void tell(struct server_registry *registry, const struct server_record *record)
{
    if (registry->gone && !server_registry_holds(registry, record->etag)) registry->gone(registry->gone_user, record);
}

void server_listed_release(struct server_listed *listed)
{
    server_surface_release(listed->surface);
    server_record_release(listed->record);
}

/* --- memory ------------------------------------------------------------------------------------------------------- */

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
static struct slot *coldest(const struct server_registry *registry, bool without_fields)
{
    struct slot *coldest = NULL;
    for (uint32_t i = 0; i < registry->count; i++) {
        struct slot *slot = registry->slots[i];
        if (!can_unload(slot->surface) || (coldest && slot->turn >= coldest->turn)) continue;
        if (without_fields && server_shelf_count(slot->surface->shelf)) continue;
        coldest = slot;
    }
    return coldest;
}

/* Takes the coldest surface out of memory; its bytes, or 0 when there is none. */
static size_t unload_one(struct server_registry *registry, bool without_fields)
{
    pthread_rwlock_wrlock(&registry->lock);
    struct slot *slot = coldest(registry, without_fields);
    struct server_surface *surface = slot ? slot->surface : NULL;
    if (slot) slot->surface = NULL;
    pthread_rwlock_unlock(&registry->lock);
    if (!surface) return 0;
    size_t bytes = surface->bytes;
    retire(surface);
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

/* --- life --------------------------------------------------------------------------------------------------------- */

static bool on_stored(void *user, struct server_record *record, const struct server_store_uses *uses)
{
    struct server_registry *registry = user;
    struct slot *slot = reserve(registry) ? create_slot(record) : NULL;
    registry->is_incomplete |= !slot;
    if (!slot) return false;
    slot->uses = slot->noted = uses->count;
    slot->last = uses->last;
    registry->slots[registry->count++] = slot;
    return true;
}

struct server_registry *server_registry_create(struct server_store *store, struct server_budget *budget)
{
    struct server_registry *registry = calloc(1, sizeof *registry);
    if (!registry) {
        store->close(store);
        return NULL;
    }
    registry->store = store;
    registry->budget = budget;
    pthread_mutex_init(&registry->writing, NULL);
    pthread_rwlock_init(&registry->lock, NULL);
    store->each(store, on_stored, registry);
    if (registry->is_incomplete) {
        server_registry_destroy(registry);
        return NULL;
    }
    if (!store->fetch) return registry; /* what is unloaded would be lost */
    budget->reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){unload_idle, NULL, registry};
    budget->reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){unload_any, unloadable, registry};
    return registry;
}

void server_registry_destroy(struct server_registry *registry)
{
    if (!registry) return;
    registry->budget->reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){0};
    registry->budget->reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){0};
    for (uint32_t i = 0; i < registry->count; i++) destroy_slot(registry->slots[i]);
    registry->store->close(registry->store);
    pthread_rwlock_destroy(&registry->lock);
    pthread_mutex_destroy(&registry->writing);
    free(registry->slots);
    free(registry);
}

void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record), void *user)
{
    registry->gone = gone;
    registry->gone_user = user;
}

/* --- writing ------------------------------------------------------------------------------------------------------ */

/* Under the writer lock: nobody else changes what a name is. */
static struct slot *current(struct server_registry *registry, const char *name)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct slot *slot = find(registry, name);
    pthread_rwlock_unlock(&registry->lock);
    return slot;
}

/* Gives the slot a record and a surface; those that it had go to `*before`. */
static void replace(struct server_registry *registry, struct slot *slot, struct server_surface *surface,
                    struct server_listed *before)
{
    pthread_rwlock_wrlock(&registry->lock);
    *before = (struct server_listed){slot->record, slot->surface};
    slot->record = server_record_retain(surface->record);
    slot->surface = server_surface_retain(surface);
    slot->uses = slot->noted = 0;
    touch(registry, slot);
    pthread_rwlock_unlock(&registry->lock);
}

/* The slot, with room for it. NULL without memory. */
static struct slot *prepare_slot(struct server_registry *registry, struct server_surface *surface)
{
    pthread_rwlock_wrlock(&registry->lock);
    bool has_room = reserve(registry);
    pthread_rwlock_unlock(&registry->lock);
    struct slot *slot = has_room ? create_slot(surface->record) : NULL;
    if (!slot) return NULL;
    slot->surface = server_surface_retain(surface);
    touch(registry, slot);
    return slot;
}

static enum server_store_outcome put_new(struct server_registry *registry, struct server_surface *surface,
                                         const void *bytes)
{
    struct slot *slot = prepare_slot(registry, surface);
    if (!slot) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome = registry->store->put(registry->store, surface->record, bytes);
    if (outcome) {
        server_record_release(slot->record);
        server_surface_release(slot->surface); /* not retired: it is its maker's still */
        free(slot);
        return outcome;
    }
    pthread_rwlock_wrlock(&registry->lock);
    insert(registry, slot);
    pthread_rwlock_unlock(&registry->lock);
    return SERVER_STORE_CREATED;
}

static enum server_store_outcome put_under_lock(struct server_registry *registry, struct server_surface *surface,
                                                const void *bytes, const struct server_precondition *precondition,
                                                struct server_listed *before)
{
    struct slot *slot = current(registry, surface->record->name);
    if (!server_precondition_holds(precondition, slot ? slot->record->etag : NULL)) return SERVER_STORE_PRECONDITION;
    if (!slot) return put_new(registry, surface, bytes);
    bool is_same = slot->record == surface->record;
    enum server_store_outcome outcome = is_same ? registry->store->keep(registry->store, surface->record, bytes)
                                                : registry->store->put(registry->store, surface->record, bytes);
    if (outcome) return outcome;
    if (is_same)
        server_registry_keep(registry, surface);
    else
        replace(registry, slot, surface, before);
    return SERVER_STORE_REPLACED;
}

enum server_store_outcome server_registry_put(struct server_registry *registry, struct server_surface *surface,
                                              const void *bytes, const struct server_precondition *precondition)
{
    struct server_listed before = {0};
    pthread_mutex_lock(&registry->writing);
    enum server_store_outcome outcome = put_under_lock(registry, surface, bytes, precondition, &before);
    pthread_mutex_unlock(&registry->writing);
    retire(before.surface);
    if (before.record) tell(registry, before.record);
    server_record_release(before.record);
    return outcome;
}

static enum server_store_outcome remove_under_lock(struct server_registry *registry, const char *name,
                                                   const struct server_precondition *precondition,
                                                   struct slot **removed)
{
    struct slot *slot = current(registry, name);
    if (!slot) return SERVER_STORE_ABSENT;
    if (!server_precondition_holds(precondition, slot->record->etag)) return SERVER_STORE_PRECONDITION;
    enum server_store_outcome outcome = registry->store->remove(registry->store, slot->record);
    if (outcome) return outcome;
    pthread_rwlock_wrlock(&registry->lock);
    *removed = extract(registry, name);
    pthread_rwlock_unlock(&registry->lock);
    return SERVER_STORE_DONE;
}

enum server_store_outcome server_registry_remove(struct server_registry *registry, const char *name,
                                                 const struct server_precondition *precondition)
{
    struct slot *removed = NULL;
    pthread_mutex_lock(&registry->writing);
    enum server_store_outcome outcome = remove_under_lock(registry, name, precondition, &removed);
    pthread_mutex_unlock(&registry->writing);
    if (removed) tell(registry, removed->record);
    destroy_slot(removed);
    return outcome;
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

static struct server_listed share(const struct slot *slot)
{
    return (struct server_listed){server_record_retain(slot->record),
                                  slot->surface ? server_surface_retain(slot->surface) : NULL};
}

bool server_registry_find(struct server_registry *registry, const char *name, struct server_listed *out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct slot *slot = find(registry, name);
    if (slot) *out = share(slot);
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

bool server_registry_use(struct server_registry *registry, const char *name, struct server_listed *out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct slot *slot = find(registry, name);
    if (slot) {
        touch(registry, slot);
        *out = share(slot);
    }
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

uint32_t server_registry_list(struct server_registry *registry, const char *after, uint32_t most,
                              struct server_listed *out)
{
    uint32_t listed = 0;
    pthread_rwlock_rdlock(&registry->lock);
    uint32_t at = after ? lower_bound(registry, after) : 0;
    if (after && at < registry->count && strcmp(registry->slots[at]->record->name, after) == 0) at++;
    for (; listed < most && at < registry->count; at++) out[listed++] = share(registry->slots[at]);
    pthread_rwlock_unlock(&registry->lock);
    return listed;
}

struct server_registry_statistics server_registry_statistics(struct server_registry *registry)
{
    struct server_registry_statistics statistics = {.loads = registry->loads, .unloads = registry->unloads};
    pthread_rwlock_rdlock(&registry->lock);
    statistics.surfaces = registry->count;
    for (uint32_t i = 0; i < registry->count; i++) statistics.loaded += registry->slots[i]->surface != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return statistics;
}

const char *server_registry_health(struct server_registry *registry)
{
    return registry->store->health(registry->store);
}

/* --- loading ------------------------------------------------------------------------------------------------------ */

enum server_store_outcome server_registry_fetch(struct server_registry *registry, const struct server_record *record,
                                                void **bytes)
{
    return registry->store->fetch(registry->store, record, bytes);
}

void server_registry_keep(struct server_registry *registry, struct server_surface *surface)
{
    pthread_rwlock_wrlock(&registry->lock);
    struct slot *slot = find(registry, surface->record->name);
    if (slot && slot->record == surface->record && !slot->surface) {
        slot->surface = server_surface_retain(surface);
        atomic_fetch_add(&registry->loads, 1);
    }
    pthread_rwlock_unlock(&registry->lock);
}

/* Was `a` used more than `b`? Of equals, the later one. */
static bool is_hotter(const struct slot *a, const struct slot *b)
{
    return a->uses != b->uses ? a->uses > b->uses : a->last > b->last;
}

struct server_record *server_registry_hottest(struct server_registry *registry)
{
    const struct slot *hottest = NULL;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count; i++) {
        const struct slot *slot = registry->slots[i];
        if (!slot->surface && !slot->was_tried && (!hottest || is_hotter(slot, hottest))) hottest = slot;
    }
    if (hottest) atomic_store(&((struct slot *)hottest)->was_tried, true);
    struct server_record *record = hottest ? server_record_retain(hottest->record) : NULL;
    pthread_rwlock_unlock(&registry->lock);
    return record;
}

/* --- uses --------------------------------------------------------------------------------------------------------- */

/* Collects the records of the slots whose uses changed, up to `most`. Under the writer lock, so that the records stay. */
static uint32_t collect_uses(struct server_registry *registry, uint32_t most, const struct server_record **records,
                             struct server_store_uses *uses)
{
    uint32_t count = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count && count < most; i++) {
        struct slot *slot = registry->slots[i];
        uint64_t now = atomic_load(&slot->uses);
        if (now == slot->noted) continue;
        slot->noted = now;
        records[count] = slot->record;
        uses[count++] = (struct server_store_uses){now, atomic_load(&slot->last)};
    }
    pthread_rwlock_unlock(&registry->lock);
    return count;
}

#define NOTED_AT_ONCE 256

void server_registry_note_uses(struct server_registry *registry)
{
    const struct server_record *records[NOTED_AT_ONCE];
    struct server_store_uses uses[NOTED_AT_ONCE];
    uint32_t count;
    do {
        pthread_mutex_lock(&registry->writing);
        count = collect_uses(registry, NOTED_AT_ONCE, records, uses);
        if (count) registry->store->note_uses(registry->store, records, uses, count);
        pthread_mutex_unlock(&registry->writing);
    } while (count == NOTED_AT_ONCE);
}
