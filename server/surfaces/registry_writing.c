/* See registry.h: what changes the registry, and what tells the store of its use. */
#include <stdlib.h>
#include <string.h>

#include "server/surfaces/registry_slots.h"

#define DECISIONS 8 /* when other daemons are always quicker */

void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record), void *user)
{
    registry->gone = gone;
    registry->gone_user = user;
}

/* --- putting and removing --------------------------------------------------------------------- */

void server_registry_submit(struct server_registry *registry, struct server_job *job)
{
    (void)server_workers_submit(registry->writer, job); /* its queue is never full */
}

void server_registry_expire(struct server_registry *registry, uint64_t now_ns)
{
    server_workers_expire(registry->writer, now_ns);
    server_workers_expire(registry->reader, now_ns);
}

void server_registry_cancel(struct server_registry *registry)
{
    server_workers_cancel(registry->writer);
}

void server_registry_submit_list(struct server_registry *registry, struct server_job *job)
{
    (void)server_workers_submit(registry->reader, job); /* its queue is never full */
}

/* Under the writer lock: what the key has, retained; false: nothing. Another daemon may change it
 * at any time, this one can't. */
static bool find_current(struct server_registry *registry, const struct server_key *key,
                         struct server_listed *out, uint64_t *version)
{
    pthread_rwlock_rdlock(&registry->lock);
    const struct server_slot *slot = server_slots_find(registry, key);
    *version = slot ? slot->version : 0;
    *out = (struct server_listed){
        .record = slot ? server_record_retain(slot->record) : NULL,
        .surface = slot && slot->surface ? server_surface_retain(slot->surface) : NULL};
    pthread_rwlock_unlock(&registry->lock);
    return out->record != NULL;
}

/* Under the follower's and the slots' lock: is a change that this daemon has made, of that version
 * (0: the store is not shared), newer than what the slots say of its key? Else it is there already,
 * or what came after it is. */
static bool is_news(const struct server_registry *registry, const struct server_slot *slot,
                    uint64_t version)
{
    return !version || (version > registry->seen && (!slot || slot->version < version));
}

/* A slot for a surface, with room for it. NULL without memory. */
static struct server_slot *prepare_slot(struct server_registry *registry,
                                        struct server_surface *surface)
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

/* A slot that came nowhere; its surface is not retired: it is its maker's still. */
static void drop_slot(struct server_slot *slot)
{
    server_record_release(slot->record);
    server_surface_release(slot->surface);
    free(slot);
}

/* Puts a slot into the place of the one that its key has; what is left over goes to `*before`. */
static void enter(struct server_registry *registry, struct server_slot *slot,
                  struct server_slot **before)
{
    const struct server_key key = server_record_key(slot->record);
    *before = NULL;
    pthread_mutex_lock(&registry->following);
    pthread_rwlock_wrlock(&registry->lock);
    struct server_slot *found = server_slots_find(registry, &key);
    /* the follower was quicker */
    bool is_told = found && found->version && found->version == slot->version;
    bool enters = is_told || is_news(registry, found, slot->version);
    if (enters && found) *before = server_slots_extract(registry, &key);
    if (enters && server_slots_reserve(registry))
        server_slots_insert(registry, slot);
    else
        drop_slot(slot);
    pthread_rwlock_unlock(&registry->lock);
    pthread_mutex_unlock(&registry->following);
}

/* What the surface is made from; `bytes`: its file. */
static struct server_content content_of(const struct server_surface *surface, const void *bytes)
{
    return (struct server_content){
        .parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = surface->attachment}};
}

static enum server_store_outcome put_other(struct server_registry *registry,
                                           struct server_surface *surface,
                                           const struct server_content *content, uint64_t version,
                                           struct server_slot **before)
{
    struct server_slot *slot = prepare_slot(registry, surface);
    if (!slot) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome =
        registry->store->put(registry->store, surface->record, content, &version);
    if (outcome) {
        drop_slot(slot);
        return outcome;
    }
    slot->version = version;
    enter(registry, slot, before);
    return SERVER_STORE_DONE;
}

/* Brings the surface's bytes to the store, and learns what others have done to it. */
static enum server_store_outcome stage(struct server_registry *registry,
                                       const struct server_surface *surface,
                                       const struct server_content *content)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    if (registry->store->stage)
        outcome = registry->store->stage(registry->store, surface->record, content);
    return outcome ? outcome : server_registry_follow(registry, gd_now_ns());
}

static enum server_store_outcome put_under_lock(struct server_registry *registry,
                                                struct server_surface *surface,
                                                const struct server_content *content,
                                                const struct server_precondition *precondition,
                                                struct server_slot **before)
{
    const struct server_key key = server_record_key(surface->record);
    struct server_listed now;
    uint64_t version;
    enum server_store_outcome outcome = stage(registry, surface, content);
    if (outcome) return outcome;
    bool exists = find_current(registry, &key, &now, &version);
    bool is_same = exists && now.record == surface->record;
    if (!server_precondition_holds(precondition, exists ? now.record->etag : NULL))
        outcome = SERVER_STORE_PRECONDITION;
    else if (is_same)
        outcome = registry->store->keep(registry->store, surface->record, content);
    else
        outcome = put_other(registry, surface, content, version, before);
    server_listed_release(&now);
    if (outcome) return outcome;
    if (is_same) server_registry_keep(registry, surface);
    return exists ? SERVER_STORE_REPLACED : SERVER_STORE_CREATED;
}

/* Tells of a slot that has left, and destroys it; NULL is harmless. */
static void see_off(struct server_registry *registry, struct server_slot *slot)
{
    struct server_record *record = slot ? server_record_retain(slot->record) : NULL;
    server_slot_destroy(slot);
    if (record) server_slots_tell(registry, record);
    server_record_release(record);
}

enum server_store_outcome server_registry_put(struct server_registry *registry,
                                              struct server_surface *surface, const void *bytes,
                                              const struct server_precondition *precondition)
{
    const struct server_content content = content_of(surface, bytes);
    struct server_slot *before = NULL;
    enum server_store_outcome outcome = SERVER_STORE_STALE;
    if (!server_record_take(surface->record, registry->budget)) return SERVER_STORE_NO_MEMORY;
    pthread_mutex_lock(&registry->writing);
    for (int i = 0; i < DECISIONS && outcome == SERVER_STORE_STALE; i++)
        outcome = put_under_lock(registry, surface, &content, precondition, &before);
    if (outcome == SERVER_STORE_CREATED || outcome == SERVER_STORE_REPLACED)
        registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    see_off(registry, before);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_UNAVAILABLE : outcome;
}

enum server_store_outcome server_registry_confirm(struct server_registry *registry,
                                                  const struct server_surface *surface,
                                                  const void *bytes)
{
    const struct server_content content = content_of(surface, bytes);
    const struct server_key key = server_record_key(surface->record);
    struct server_listed now = {0};
    uint64_t version;
    pthread_mutex_lock(&registry->writing);
    enum server_store_outcome outcome = stage(registry, surface, &content);
    if (!outcome &&
        (!find_current(registry, &key, &now, &version) || now.record != surface->record))
        outcome = SERVER_STORE_ABSENT;
    if (!outcome) outcome = registry->store->keep(registry->store, surface->record, &content);
    pthread_mutex_unlock(&registry->writing);
    server_listed_release(&now);
    return outcome == SERVER_STORE_DONE ? SERVER_STORE_REPLACED : outcome;
}

/* Takes the slot out whose key was removed in that version. */
static struct server_slot *leave(struct server_registry *registry, const struct server_key *key,
                                 uint64_t version)
{
    struct server_slot *left = NULL;
    pthread_mutex_lock(&registry->following);
    pthread_rwlock_wrlock(&registry->lock);
    const struct server_slot *found = server_slots_find(registry, key);
    if (found && is_news(registry, found, version)) left = server_slots_extract(registry, key);
    pthread_rwlock_unlock(&registry->lock);
    pthread_mutex_unlock(&registry->following);
    return left;
}

static enum server_store_outcome remove_under_lock(struct server_registry *registry,
                                                   const struct server_key *key,
                                                   const struct server_precondition *precondition,
                                                   struct server_slot **removed)
{
    struct server_listed now;
    uint64_t version;
    enum server_store_outcome outcome = server_registry_follow(registry, gd_now_ns());
    if (outcome) return outcome;
    if (!find_current(registry, key, &now, &version)) return SERVER_STORE_ABSENT;
    outcome = server_precondition_holds(precondition, now.record->etag)
                  ? registry->store->remove(registry->store, now.record, &version)
                  : SERVER_STORE_PRECONDITION;
    server_listed_release(&now);
    if (!outcome) *removed = leave(registry, key, version);
    return outcome;
}

enum server_store_outcome server_registry_remove(struct server_registry *registry,
                                                 const struct server_key *key,
                                                 const struct server_precondition *precondition)
{
    struct server_slot *removed = NULL;
    enum server_store_outcome outcome = SERVER_STORE_STALE;
    pthread_mutex_lock(&registry->writing);
    for (int i = 0; i < DECISIONS && outcome == SERVER_STORE_STALE; i++)
        outcome = remove_under_lock(registry, key, precondition, &removed);
    if (outcome == SERVER_STORE_DONE) registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    see_off(registry, removed);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_UNAVAILABLE : outcome;
}

/* --- uses ------------------------------------------------------------------------------------- */

/* Collects the records of the slots whose uses changed, up to `most`. Under the writer lock, so
 * that the records stay. */
static uint32_t collect_uses(struct server_registry *registry, uint32_t most,
                             const struct server_record **records, struct server_store_uses *uses)
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
