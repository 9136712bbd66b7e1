#include "server/surfaces/registry.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/thread.h"
#include "server/surfaces/slots.h"

/* largest number of attempts at a change while other daemons make changes */
#define ATTEMPTS      8
#define NOTED_AT_ONCE 256 /* numbers of uses that are stored under one writer lock */
#define FRESH_NS      UINT64_C(1000000000) /* see server/doc/014 */
#define AWAIT_NS      UINT64_C(200000000)

struct server_registry {
    struct server_store *store;
    struct server_budget *budget;
    pthread_mutex_t writing;
    pthread_rwlock_t lock;
    /* slots sorted by key; they are guarded by `lock` too */
    struct server_sorted all;
    void (*gone)(void *user, const struct server_record *record); /* or NULL */
    void *gone_user;
    atomic_uint_least64_t clock, loads, unloads;
    /* used for a shared store: */
    pthread_mutex_t following;
    uint64_t seen; /* all changes up to this version are applied; guarded by `following` */
    atomic_uint_least64_t followed_ns; /* time at which the last successful following began */
    struct server_thread *follower;    /* NULL means that the store is not shared */
};

/* --- slots ------------------------------------------------------------------------------------ */

static void slot_touch(struct server_registry *registry, struct server_slot *slot)
{
    atomic_store_explicit(&slot->turn,
                          atomic_fetch_add_explicit(&registry->clock, 1, memory_order_relaxed),
                          memory_order_relaxed);
    atomic_fetch_add_explicit(&slot->uses, 1, memory_order_relaxed);
    atomic_store_explicit(&slot->last, time(NULL), memory_order_relaxed);
}

/* Destroys a removed slot and its surface, and calls the watcher. NULL is allowed. */
static void slot_leave(struct server_registry *registry, struct server_slot *slot)
{
    if (!slot) return;
    if (slot->now.surface) server_surface_retire(slot->now.surface);
    if (registry->gone && !server_registry_holds(registry, slot->now.record->etag))
        registry->gone(registry->gone_user, slot->now.record);
    server_slot_free(slot);
}

/* --- memory ----------------------------------------------------------------------------------- */

static bool can_unload(const struct server_surface *surface)
{
    return surface && atomic_load(&surface->references) == 1;
}

/* Returns the bytes of the surfaces that could be unloaded at this moment. */
static size_t registry_unloadable(void *user)
{
    struct server_registry *registry = user;
    size_t bytes = 0;
    SERVER_READ_LOCK(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count; i++) {
        const struct server_slot *slot = registry->all.items[i];
        if (can_unload(slot->now.surface)) bytes += slot->now.surface->bytes;
    }
    return bytes;
}

/* Finds the least recently used surface that can be unloaded, and removes it from its slot. Returns
 * the surface, or NULL if there is none. */
static struct server_surface *surface_take_coldest(struct server_registry *registry,
                                                   bool without_fields)
{
    struct server_slot *coldest = NULL;
    struct server_surface *surface = NULL;
    SERVER_WRITE_LOCK(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count; i++) {
        struct server_slot *slot = registry->all.items[i];
        if (!can_unload(slot->now.surface) || (coldest && slot->turn >= coldest->turn)) continue;
        if (without_fields && server_mesh_cache_count(slot->now.surface->fields)) continue;
        coldest = slot;
    }
    if (coldest) {
        surface = coldest->now.surface;
        coldest->now.surface = NULL;
    }
    return surface;
}

static void surfaces_unload(struct server_registry *registry, size_t bytes, bool without_fields)
{
    struct server_surface *surface;
    for (size_t freed = 0;
         freed < bytes && (surface = surface_take_coldest(registry, without_fields));) {
        freed += surface->bytes;
        server_surface_release(surface); /* this is the last reference */
        atomic_fetch_add(&registry->unloads, 1);
    }
}

static void unload_idle(void *user, size_t bytes)
{
    surfaces_unload(user, bytes, true);
}

static void unload_any(void *user, size_t bytes)
{
    surfaces_unload(user, bytes, false);
}

/* --- reading ---------------------------------------------------------------------------------- */

bool server_registry_holds(struct server_registry *registry, const char *etag)
{
    bool found = false;
    SERVER_READ_LOCK(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count && !found; i++)
        found = strcmp(((struct server_slot *)registry->all.items[i])->now.record->etag, etag) == 0;
    return found;
}

bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out)
{
    SERVER_READ_LOCK(&registry->lock);
    const struct server_slot *slot = server_sorted_find(&registry->all, key);
    if (slot) *out = server_slot_share(slot);
    return slot != NULL;
}

bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out)
{
    SERVER_READ_LOCK(&registry->lock);
    struct server_slot *slot = server_sorted_find(&registry->all, key);
    if (slot) {
        slot_touch(registry, slot);
        *out = slot->now.surface ? server_surface_retain(slot->now.surface) : NULL;
    }
    return slot != NULL;
}

uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              const char *prefix, uint32_t most, struct server_listed *out)
{
    const char *name = after->name ? after->name : "", *begin = prefix ? prefix : "";
    const struct server_key from = {after->tenant, after->kind, name};
    const struct server_key first = {after->tenant, after->kind, begin};
    uint32_t listed = 0;
    SERVER_READ_LOCK(&registry->lock);
    /* In byte order, names with the prefix `begin` are adjacent. */
    uint32_t at = strcmp(name, begin) < 0 ? server_sorted_index(&registry->all, &first)
                                          : server_sorted_after(&registry->all, &from);
    for (; listed < most && at < registry->all.count; at++) {
        const struct server_slot *slot = registry->all.items[at];
        const struct server_record *record = slot->now.record;
        if (record->kind != from.kind || strcmp(record->tenant, from.tenant) != 0 ||
            strncmp(record->name, begin, strlen(begin)) != 0)
            break;
        out[listed++] = server_slot_share(slot);
    }
    return listed;
}

bool server_registry_next(struct server_registry *registry, struct server_listed *listed)
{
    struct server_listed before = *listed;
    struct server_key key;
    uint32_t at = 0;
    *listed = (struct server_listed){0};
    if (before.record) key = server_record_key(before.record);
    pthread_rwlock_rdlock(&registry->lock);
    if (before.record) at = server_sorted_after(&registry->all, &key);
    if (at < registry->all.count) *listed = server_slot_share(registry->all.items[at]);
    pthread_rwlock_unlock(&registry->lock);
    server_listed_release(&before);
    return listed->record != NULL;
}

struct server_registry_statistics server_registry_statistics(struct server_registry *registry)
{
    struct server_registry_statistics statistics = {.loads = registry->loads,
                                                    .unloads = registry->unloads};
    if (registry->store->damaged) statistics.damaged = registry->store->damaged(registry->store);
    SERVER_READ_LOCK(&registry->lock);
    statistics.surfaces = registry->all.count;
    for (uint32_t i = 0; i < registry->all.count; i++)
        statistics.loaded += ((struct server_slot *)registry->all.items[i])->now.surface != NULL;
    return statistics;
}

const char *server_registry_health(struct server_registry *registry)
{
    return registry->store->health ? registry->store->health(registry->store) : NULL;
}

/* --- loading and uses ------------------------------------------------------------------------- */

struct server_store *server_registry_store(const struct server_registry *registry)
{
    return registry->store;
}

void server_registry_keep(struct server_registry *registry, struct server_surface *surface)
{
    SERVER_WRITE_LOCK(&registry->lock);
    struct server_slot *slot = server_slots_of_record(&registry->all, surface->record);
    if (slot && !slot->now.surface) {
        slot->now.surface = server_surface_retain(surface);
        atomic_fetch_add(&registry->loads, 1);
    }
}

struct server_record *server_registry_hottest(struct server_registry *registry)
{
    struct server_slot *hottest = NULL;
    SERVER_READ_LOCK(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count; i++) {
        struct server_slot *slot = registry->all.items[i];
        if (slot->now.surface || slot->was_tried) continue;
        if (!hottest || slot->uses > hottest->uses ||
            (slot->uses == hottest->uses && slot->last > hottest->last))
            hottest = slot;
    }
    if (hottest) atomic_store(&hottest->was_tried, true);
    return hottest ? server_record_retain(hottest->now.record) : NULL;
}

/* Collects up to NOTED_AT_ONCE changed numbers of uses. The caller must hold the writer lock, so
 * that the records stay valid. */
static uint32_t slots_collect_uses(struct server_registry *registry,
                                   const struct server_record **records,
                                   struct server_store_uses *uses)
{
    uint32_t count = 0;
    SERVER_READ_LOCK(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count && count < NOTED_AT_ONCE; i++) {
        struct server_slot *slot = registry->all.items[i];
        uint64_t now = atomic_load(&slot->uses);
        if (now == slot->noted) continue;
        slot->noted = now;
        records[count] = slot->now.record;
        uses[count++] = (struct server_store_uses){now, atomic_load(&slot->last)};
    }
    return count;
}

void server_registry_note_uses(struct server_registry *registry)
{
    const struct server_record *records[NOTED_AT_ONCE];
    struct server_store_uses uses[NOTED_AT_ONCE];
    uint32_t count;
    do {
        pthread_mutex_lock(&registry->writing);
        count = slots_collect_uses(registry, records, uses);
        if (count && registry->store->note_uses)
            registry->store->note_uses(registry->store, records, uses, count);
        pthread_mutex_unlock(&registry->writing);
    } while (count == NOTED_AT_ONCE);
}

/* --- following a shared store ----------------------------------------------------------------- */

static bool on_change(void *user, const struct server_stored *change)
{
    struct server_registry *registry = user;
    struct server_slot *left = NULL;
    struct server_key key;
    char text[SERVER_KEY_TEXT];
    if (strlen(change->key) >= sizeof text) return true;
    strcpy(text, change->key);
    /* a later version of this program wrote the key */
    if (!server_key_read(text, &key)) return true;
    pthread_rwlock_wrlock(&registry->lock);
    bool is_applied = server_slots_follow(&registry->all, registry->budget, &key, change, &left);
    pthread_rwlock_unlock(&registry->lock);
    if (is_applied) registry->seen = change->version;
    slot_leave(registry, left);
    return is_applied;
}

/* Reads the whole store again. Called if the store no longer lists the changes, because they are
 * old or the store was restored. */
static enum server_outcome registry_reread(struct server_registry *registry)
{
    struct server_sorted fresh;
    enum server_outcome outcome = server_slots_collect(registry->store, registry->budget, &fresh);
    if (!outcome) {
        pthread_rwlock_wrlock(&registry->lock);
        server_slots_keep(&registry->all, &fresh);
        struct server_sorted before = registry->all;
        registry->all = fresh;
        fresh = before;
        pthread_rwlock_unlock(&registry->lock);
        /* the slots were not read at one moment, so follow must compare all versions */
        registry->seen = 0;
    }
    for (uint32_t i = 0; i < fresh.count; i++) slot_leave(registry, fresh.items[i]);
    free(fresh.items);
    return outcome;
}

bool server_registry_is_shared(const struct server_registry *registry)
{
    return registry->store->follow != NULL;
}

enum server_outcome server_registry_follow(struct server_registry *registry, uint64_t since_ns)
{
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (!server_registry_is_shared(registry)) return outcome;
    SERVER_LOCK(&registry->following);
    if (atomic_load(&registry->followed_ns) <= since_ns) {
        uint64_t begun_ns = gd_now_ns();
        outcome = registry->store->follow(registry->store, on_change, registry);
        if (outcome == SERVER_STORE_STALE) outcome = registry_reread(registry);
        if (!outcome) atomic_store(&registry->followed_ns, begun_ns);
    }
    return outcome;
}

bool server_registry_is_fresh(struct server_registry *registry, const struct server_key *key)
{
    if (!server_registry_is_shared(registry) || server_registry_health(registry)) return true;
    if (gd_now_ns() - atomic_load(&registry->followed_ns) > FRESH_NS) return false;
    if (!key) return true;
    SERVER_READ_LOCK(&registry->lock);
    return server_sorted_find(&registry->all, key) != NULL;
}

bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record)
{
    (void)server_registry_follow(registry, gd_now_ns());
    SERVER_READ_LOCK(&registry->lock);
    return server_slots_of_record(&registry->all, record) != NULL;
}

static void follow_changes(void *user, struct server_thread *thread)
{
    struct server_registry *registry = user;
    while (server_thread_pause(thread, 0)) {
        registry->store->await(registry->store, AWAIT_NS);
        (void)server_registry_follow(registry, gd_now_ns());
    }
}

/* --- changes by this daemon ------------------------------------------------------------------- */

struct change {
    struct server_key key;
    /* surface to be stored; NULL means that the current surface gets a new caption or is removed */
    struct server_surface *surface;
    struct server_content content;
    /* the new caption; NULL means that the caption does not change */
    const char *caption;
    struct server_record *amended; /* the record with the new caption, after it was made */
    /* the condition; NULL means that the key must still have the record of `surface` */
    const struct server_precondition *precondition;
    struct server_slot *slot,
        *left; /* slot: the slot to insert; left: the replaced or removed slot; both may be NULL */
};

bool server_registry_allows(const struct server_precondition *precondition,
                            const struct server_record *record)
{
    char caption[SERVER_CAPTION];
    if (!record) return server_precondition_holds(precondition, NULL);
    server_record_caption(record, caption);
    return server_precondition_allows(precondition, record->etag, caption);
}

/* Stores a copy of the current record with the new caption. `*version` is the known version of the
 * key, or 0, and becomes the new version (see `put` in store.h). */
static enum server_outcome change_amend(struct server_store *store, struct change *change,
                                        const struct server_record *present, uint64_t *version)
{
    server_record_release(change->amended); /* releases the record of an earlier attempt */
    change->amended = server_record_copy(present, change->caption);
    if (!change->amended) return SERVER_STORE_NO_MEMORY;
    return store->put ? store->put(store, change->amended, NULL, version) : SERVER_STORE_DONE;
}

/* Makes the store apply the change to `now`. Sets `*version` to the new version. */
static enum server_outcome change_store(const struct server_registry *registry,
                                        struct change *change, const struct server_listed *now,
                                        uint64_t *version)
{
    struct server_store *store = registry->store;
    struct server_record *record = change->surface ? change->surface->record : NULL;
    bool is_same = now->record && now->record == record;
    if (!record && !now->record) return SERVER_STORE_ABSENT;
    if (!change->precondition && !is_same) return SERVER_STORE_ABSENT;
    if (change->precondition && !server_registry_allows(change->precondition, now->record))
        return SERVER_STORE_PRECONDITION;
    if (change->caption) return change_amend(store, change, now->record, version);
    if (is_same && store->keep) return store->keep(store, record, &change->content);
    /* the objects are already staged, or nothing is stored */
    if (is_same || !store->put) return SERVER_STORE_DONE;
    return record ? store->put(store, record, &change->content, version)
                  : store->remove(store, now->record, version);
}

/* Applies a stored change to the slots, unless they already have this or a later change. Version 0
 * means that the store is not shared. */
static void change_apply(struct server_registry *registry, struct change *change, uint64_t version)
{
    struct server_sorted *all = &registry->all;
    pthread_mutex_lock(&registry->following);
    pthread_rwlock_wrlock(&registry->lock);
    struct server_slot *found = server_sorted_find(all, &change->key);
    bool follower_was_quicker = found && found->version && found->version == version;
    bool is_news = !version || (version > registry->seen && (!found || found->version < version));
    bool enters = follower_was_quicker || is_news;
    if (enters && change->slot && server_sorted_reserve(all)) {
        slot_touch(registry, found ? found : change->slot);
        change->slot->version = version;
        change->left = server_slots_enter(all, change->slot);
        change->slot = NULL;
    } else if (change->caption) {
        if (is_news && found && server_record_is_same_upload(found->now.record, change->amended)) {
            server_record_exchange_captions(found->now.record, change->amended);
            found->version = version;
        }
    } else if (enters && found && !change->surface) {
        change->left = server_sorted_remove(all, server_sorted_index(all, &change->key));
    }
    pthread_rwlock_unlock(&registry->lock);
    pthread_mutex_unlock(&registry->following);
}

/* Makes a change. Returns STALE if another daemon has changed the surface meanwhile. */
static enum server_outcome change_make(struct server_registry *registry, struct change *change)
{
    struct server_store *store = registry->store;
    struct server_surface *surface = change->surface;
    enum server_outcome outcome = SERVER_STORE_DONE;
    struct server_listed now = {0};
    uint64_t version = 0;
    if (surface && store->stage) outcome = store->stage(store, surface->record, &change->content);
    if (!outcome) outcome = server_registry_follow(registry, gd_now_ns());
    if (outcome) return outcome;
    pthread_rwlock_wrlock(&registry->lock);
    bool has_room = !surface || server_sorted_reserve(&registry->all);
    const struct server_slot *slot = server_sorted_find(&registry->all, &change->key);
    if (slot) {
        now = server_slot_share(slot);
        version = slot->version;
    }
    pthread_rwlock_unlock(&registry->lock);
    bool exists = now.record, is_same = surface && now.record == surface->record;
    outcome = has_room ? change_store(registry, change, &now, &version) : SERVER_STORE_NO_MEMORY;
    server_listed_release(&now);
    if (outcome) return outcome;
    if (is_same)
        server_registry_keep(registry, surface);
    else
        change_apply(registry, change, version);
    return !surface ? SERVER_STORE_DONE : exists ? SERVER_STORE_REPLACED : SERVER_STORE_CREATED;
}

static enum server_outcome change_run(struct server_registry *registry, struct change *change)
{
    enum server_outcome outcome = SERVER_STORE_STALE;
    pthread_mutex_lock(&registry->writing);
    for (int i = 0; i < ATTEMPTS && outcome == SERVER_STORE_STALE; i++)
        outcome = change_make(registry, change);
    if (outcome <= SERVER_STORE_REPLACED && registry->store->tidy)
        registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    slot_leave(registry, change->left);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_UNAVAILABLE : outcome;
}

enum server_outcome server_registry_put(struct server_registry *registry,
                                        struct server_surface *surface, const void *bytes,
                                        const struct server_precondition *precondition)
{
    struct change change = {
        .key = server_record_key(surface->record),
        .surface = surface,
        .content =
            {.parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = surface->attachment}},
        .precondition = precondition};
    if (!server_record_take(surface->record, registry->budget)) return SERVER_STORE_NO_MEMORY;
    change.slot = server_slot_create(surface->record, surface);
    if (!change.slot) return SERVER_STORE_NO_MEMORY;
    enum server_outcome outcome = change_run(registry, &change);
    server_slot_free(change.slot);
    return outcome;
}

enum server_outcome server_registry_remove(struct server_registry *registry,
                                           const struct server_key *key,
                                           const struct server_precondition *precondition)
{
    struct change change = {.key = *key, .precondition = precondition};
    return change_run(registry, &change);
}

enum server_outcome server_registry_caption(struct server_registry *registry,
                                            const struct server_key *key, const char *caption,
                                            const struct server_precondition *precondition)
{
    struct change change = {.key = *key, .caption = caption, .precondition = precondition};
    enum server_outcome outcome = change_run(registry, &change);
    server_record_release(change.amended);
    return outcome;
}

/* --- life ------------------------------------------------------------------------------------- */

void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record), void *user)
{
    registry->gone = gone;
    registry->gone_user = user;
}

static bool registry_start(struct server_registry *registry)
{
    if (server_slots_collect(registry->store, registry->budget, &registry->all)) return false;
    if (!server_registry_is_shared(registry)) return true;
    if (server_registry_follow(registry, gd_now_ns())) return false;
    registry->follower = server_thread_start(follow_changes, registry);
    return registry->follower != NULL;
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
    pthread_mutex_init(&registry->writing, NULL);
    pthread_mutex_init(&registry->following, NULL);
    pthread_rwlock_init(&registry->lock, NULL);
    registry->all.compare = server_slot_compare;
    if (!registry_start(registry)) {
        server_registry_destroy(registry);
        return NULL;
    }
    if (!store->fetch) return registry; /* without fetch, an unloaded surface would be lost */
    budget->reclaimers[SERVER_RECLAIM_IDLE] =
        (struct server_reclaimer){unload_idle, NULL, registry};
    budget->reclaimers[SERVER_RECLAIM_MESHES] =
        (struct server_reclaimer){unload_any, registry_unloadable, registry};
    return registry;
}

void server_registry_destroy(struct server_registry *registry)
{
    if (!registry) return;
    server_thread_stop(registry->follower);
    registry->budget->reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){0};
    registry->budget->reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){0};
    registry->gone = NULL;
    for (uint32_t i = 0; i < registry->all.count; i++) slot_leave(registry, registry->all.items[i]);
    registry->store->close(registry->store);
    pthread_rwlock_destroy(&registry->lock);
    pthread_mutex_destroy(&registry->following);
    pthread_mutex_destroy(&registry->writing);
    free(registry->all.items);
    free(registry);
}
