/* See registry.h: what other daemons change in a store that they share with this one. */
#include <stdlib.h>
#include <string.h>

#include "gd/control.h"
#include "server/store/key.h"
#include "server/surfaces/registry_slots.h"

#define FRESH_NS UINT64_C(1000000000) /* what is promised (doc 014), */
#define AWAIT_NS UINT64_C(200000000)  /* and how often is looked */

/* --- one change ------------------------------------------------------------------------------- */

/* What has left the slots, to be told of and released without the lock. */
struct departure {
    struct server_record *record;
    struct server_surface *surface;
};

static void see_off(struct server_registry *registry, struct departure *departure)
{
    server_slot_retire(departure->surface);
    if (departure->record) server_slots_tell(registry, departure->record);
    server_record_release(departure->record);
}

static void replace(const struct server_registry *registry, struct server_slot *slot,
                    const struct server_store_change *change, struct departure *before)
{
    *before = (struct departure){slot->record, slot->surface};
    slot->record = server_record_retain(change->record);
    server_record_count(change->record, registry->budget);
    slot->surface = NULL;
    slot->version = change->version;
}

/* False without memory. */
static bool insert(struct server_registry *registry, const struct server_store_change *change)
{
    struct server_slot *slot =
        server_slots_reserve(registry) ? server_slot_create(change->record) : NULL;
    if (!slot) return false;
    server_record_count(change->record, registry->budget);
    slot->version = change->version;
    server_slots_insert(registry, slot);
    return true;
}

static void extract(struct server_registry *registry, const struct server_key *key,
                    struct departure *before)
{
    struct server_slot *slot = server_slots_extract(registry, key);
    *before = (struct departure){slot->record, slot->surface};
    free(slot);
}

/* Under the slots' lock. A change that this daemon made itself is here already. False without
 * memory. */
static bool apply(struct server_registry *registry, const struct server_key *key,
                  const struct server_store_change *change, struct departure *before)
{
    struct server_slot *slot = server_slots_find(registry, key);
    if (slot && slot->version >= change->version) return true;
    if (slot && change->record)
        replace(registry, slot, change, before);
    else if (slot)
        extract(registry, key, before);
    else if (change->record)
        return insert(registry, change);
    return true;
}

static bool on_change(void *user, const struct server_store_change *change)
{
    struct server_registry *registry = user;
    struct departure before = {0};
    struct server_key key;
    char text[SERVER_KEY_TEXT];
    if (strlen(change->key) >= sizeof text) return true;
    strcpy(text, change->key);
    if (!server_key_read(text, &key)) return true; /* a later version's */
    pthread_rwlock_wrlock(&registry->lock);
    bool is_applied = apply(registry, &key, change, &before);
    pthread_rwlock_unlock(&registry->lock);
    if (is_applied) registry->seen = change->version;
    see_off(registry, &before);
    return is_applied;
}

/* --- all anew --------------------------------------------------------------------------------- */

static bool on_stored(void *user, const struct server_stored *stored)
{
    return server_slots_append(user, stored);
}

/* Keeps what did not change: the slots that have the same version change places. */
static void keep_unchanged(struct server_registry *registry, struct server_registry *fresh)
{
    for (uint32_t i = 0; i < fresh->count; i++) {
        const struct server_key key = server_record_key(fresh->slots[i]->record);
        if (!registry->count) return;
        struct server_slot *slot = server_slots_find(registry, &key);
        if (!slot || slot->version != fresh->slots[i]->version) continue;
        uint32_t at = server_slots_lower_bound(registry, &key);
        registry->slots[at] = fresh->slots[i];
        fresh->slots[i] = slot;
    }
}

static void exchange(struct server_registry *registry, struct server_registry *fresh)
{
    struct server_slot **slots = registry->slots;
    uint32_t count = registry->count, capacity = registry->capacity;
    registry->slots = fresh->slots;
    registry->count = fresh->count;
    registry->capacity = fresh->capacity;
    fresh->slots = slots;
    fresh->count = count;
    fresh->capacity = capacity;
}

static void destroy_slots(struct server_registry *registry, struct server_registry *old)
{
    for (uint32_t i = 0; i < old->count; i++) {
        struct departure departure = {old->slots[i]->record, old->slots[i]->surface};
        see_off(registry, &departure);
        free(old->slots[i]);
    }
    free(old->slots);
}

/* The store does not know any more what was changed: after a long absence, or when a backup was put
 * in its place. */
static enum server_store_outcome begin_anew(struct server_registry *registry)
{
    struct server_registry fresh = {.budget = registry->budget};
    enum server_store_outcome outcome = registry->store->each(registry->store, on_stored, &fresh);
    if (!outcome) {
        server_slots_sort(&fresh);
        pthread_rwlock_wrlock(&registry->lock);
        keep_unchanged(registry, &fresh);
        exchange(registry, &fresh);
        pthread_rwlock_unlock(&registry->lock);
        /* what was shown is no longer of one moment: versions tell, slot by slot */
        registry->seen = 0;
    }
    destroy_slots(registry, &fresh);
    return outcome;
}

/* --- following -------------------------------------------------------------------------------- */

static enum server_store_outcome follow(struct server_registry *registry)
{
    uint64_t begun_ns = gd_now_ns();
    enum server_store_outcome outcome =
        registry->store->follow(registry->store, on_change, registry);
    if (outcome == SERVER_STORE_STALE) outcome = begin_anew(registry);
    if (!outcome) atomic_store(&registry->followed_ns, begun_ns);
    return outcome;
}

bool server_registry_is_shared(const struct server_registry *registry)
{
    return registry->store->follow != NULL;
}

enum server_store_outcome server_registry_follow(struct server_registry *registry,
                                                 uint64_t since_ns)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    if (!server_registry_is_shared(registry)) return SERVER_STORE_DONE;
    pthread_mutex_lock(&registry->following);
    if (atomic_load(&registry->followed_ns) <= since_ns) outcome = follow(registry);
    pthread_mutex_unlock(&registry->following);
    return outcome;
}

bool server_registry_is_fresh(struct server_registry *registry, const struct server_key *key)
{
    if (!server_registry_is_shared(registry) || registry->store->health(registry->store))
        return true;
    if (gd_now_ns() - atomic_load(&registry->followed_ns) > FRESH_NS) return false;
    if (!key) return true;
    pthread_rwlock_rdlock(&registry->lock);
    bool is_known = server_slots_find(registry, key) != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return is_known;
}

static void run(void *user, struct server_thread *thread)
{
    struct server_registry *registry = user;
    while (server_thread_pause(thread, 0)) {
        registry->store->await(registry->store, AWAIT_NS);
        (void)server_registry_follow(registry, gd_now_ns());
    }
}

bool server_slots_start_follower(struct server_registry *registry)
{
    if (!server_registry_is_shared(registry)) return true;
    if (server_registry_follow(registry, gd_now_ns())) return false;
    registry->follower = server_thread_start(run, registry);
    return registry->follower != NULL;
}

void server_slots_stop_follower(struct server_registry *registry)
{
    server_thread_stop(registry->follower);
    registry->follower = NULL;
}
