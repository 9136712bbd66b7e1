/* See registry.h: what changes the registry, and what tells the store of its use. */
#include <stdlib.h>
#include <string.h>

#include "server/registry_slots.h"

void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record), void *user)
{
    registry->gone = gone;
    registry->gone_user = user;
}

static void tell(struct server_registry *registry, const struct server_record *record)
{
    if (registry->gone && !server_registry_holds(registry, record->etag)) registry->gone(registry->gone_user, record);
}

/* --- putting and removing ----------------------------------------------------------------------------------------- */

void server_registry_submit(struct server_registry *registry, struct server_job *job)
{
    (void)server_workers_submit(registry->writer, job); /* its queue is never full */
}

void server_registry_expire(struct server_registry *registry, uint64_t now_ns)
{
    server_workers_expire(registry->writer, now_ns);
}

void server_registry_cancel(struct server_registry *registry)
{
    server_workers_cancel(registry->writer);
}

/* Under the writer lock: nobody else changes what a key is. */
static struct server_slot *current(struct server_registry *registry, const struct server_key *key)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct server_slot *slot = server_slots_find(registry, key);
    pthread_rwlock_unlock(&registry->lock);
    return slot;
}

/* Gives the slot a record and a surface; those that it had go to `*before`. */
static void replace(struct server_registry *registry, struct server_slot *slot, struct server_surface *surface,
                    struct server_listed *before)
{
    pthread_rwlock_wrlock(&registry->lock);
    *before = (struct server_listed){slot->record, slot->surface};
    slot->record = server_record_retain(surface->record);
    slot->surface = server_surface_retain(surface);
    slot->uses = slot->noted = 0;
    server_slot_touch(registry, slot);
    pthread_rwlock_unlock(&registry->lock);
}

/* The slot, with room for it. NULL without memory. */
static struct server_slot *prepare_slot(struct server_registry *registry, struct server_surface *surface)
{
    pthread_rwlock_wrlock(&registry->lock);
    bool has_room = server_slots_reserve(registry);
    pthread_rwlock_unlock(&registry->lock);
    struct server_slot *slot = has_room ? server_slot_create(surface->record) : NULL;
    if (!slot) return NULL;
    slot->surface = server_surface_retain(surface);
    server_slot_touch(registry, slot);
    return slot;
}

/* What the surface is made from; `bytes`: its file. */
static struct server_content content_of(const struct server_surface *surface, const void *bytes)
{
    return (struct server_content){
        .parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = surface->attachment}};
}

static enum server_store_outcome put_new(struct server_registry *registry, struct server_surface *surface,
                                         const struct server_content *content)
{
    struct server_slot *slot = prepare_slot(registry, surface);
    if (!slot) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome = registry->store->put(registry->store, surface->record, content);
    if (outcome) {
        server_record_release(slot->record);
        server_surface_release(slot->surface); /* not retired: it is its maker's still */
        free(slot);
        return outcome;
    }
    pthread_rwlock_wrlock(&registry->lock);
    server_slots_insert(registry, slot);
    pthread_rwlock_unlock(&registry->lock);
    return SERVER_STORE_CREATED;
}

static enum server_store_outcome put_under_lock(struct server_registry *registry, struct server_surface *surface,
                                                const void *bytes, const struct server_precondition *precondition,
                                                struct server_listed *before)
{
    const struct server_content content = content_of(surface, bytes);
    const struct server_key key = server_record_key(surface->record);
    struct server_slot *slot = current(registry, &key);
    if (!server_precondition_holds(precondition, slot ? slot->record->etag : NULL)) return SERVER_STORE_PRECONDITION;
    if (!slot) return put_new(registry, surface, &content);
    bool is_same = slot->record == surface->record;
    enum server_store_outcome outcome = is_same ? registry->store->keep(registry->store, surface->record, &content)
                                                : registry->store->put(registry->store, surface->record, &content);
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
    if (outcome == SERVER_STORE_CREATED || outcome == SERVER_STORE_REPLACED) registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    server_slot_retire(before.surface);
    if (before.record) tell(registry, before.record);
    server_record_release(before.record);
    return outcome;
}

enum server_store_outcome server_registry_confirm(struct server_registry *registry,
                                                  const struct server_surface *surface, const void *bytes)
{
    const struct server_content content = content_of(surface, bytes);
    const struct server_key key = server_record_key(surface->record);
    enum server_store_outcome outcome = SERVER_STORE_ABSENT;
    pthread_mutex_lock(&registry->writing);
    struct server_slot *slot = current(registry, &key);
    if (slot && slot->record == surface->record)
        outcome = registry->store->keep(registry->store, surface->record, &content);
    pthread_mutex_unlock(&registry->writing);
    return outcome == SERVER_STORE_DONE ? SERVER_STORE_REPLACED : outcome;
}

static enum server_store_outcome remove_under_lock(struct server_registry *registry, const struct server_key *key,
                                                   const struct server_precondition *precondition,
                                                   struct server_slot **removed)
{
    struct server_slot *slot = current(registry, key);
    if (!slot) return SERVER_STORE_ABSENT;
    if (!server_precondition_holds(precondition, slot->record->etag)) return SERVER_STORE_PRECONDITION;
    enum server_store_outcome outcome = registry->store->remove(registry->store, slot->record);
    if (outcome) return outcome;
    pthread_rwlock_wrlock(&registry->lock);
    *removed = server_slots_extract(registry, key);
    pthread_rwlock_unlock(&registry->lock);
    return SERVER_STORE_DONE;
}

enum server_store_outcome server_registry_remove(struct server_registry *registry, const struct server_key *key,
                                                 const struct server_precondition *precondition)
{
    struct server_slot *removed = NULL;
    pthread_mutex_lock(&registry->writing);
    enum server_store_outcome outcome = remove_under_lock(registry, key, precondition, &removed);
    if (removed) registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    if (removed) tell(registry, removed->record);
    server_slot_destroy(removed);
    return outcome;
}

/* --- uses --------------------------------------------------------------------------------------------------------- */

/* Collects the records of the slots whose uses changed, up to `most`. Under the writer lock, so that the records
 * stay. */
static uint32_t collect_uses(struct server_registry *registry, uint32_t most, const struct server_record **records,
                             struct server_store_uses *uses)
{
    uint32_t count = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->count && count < most; i++) {
        struct server_slot *slot = registry->slots[i];
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
