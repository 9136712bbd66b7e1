/* See registry.h. */
#include "server/surfaces/registry.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/thread.h"

#define FIRST_CAPACITY 16
#define ATTEMPTS       8                    /* of a change, when other daemons are quicker */
#define NOTED_AT_ONCE  256                  /* uses, while the writer lock is held */
#define FRESH_NS       UINT64_C(1000000000) /* see doc/014 */
#define AWAIT_NS       UINT64_C(200000000)

struct slot {
    struct server_record *record;
    struct server_surface *surface; /* NULL: not in memory */
    atomic_uint_least64_t uses;
    atomic_int_least64_t last;  /* use, seconds since 1970 */
    atomic_uint_least64_t turn; /* of the registry's clock at the last use */
    uint64_t noted;             /* uses that the store knows; under the writer lock */
    uint64_t version;           /* of the record in a shared store */
    atomic_bool was_tried;      /* by server_registry_hottest */
};

struct slots {
    struct slot **slots; /* sorted by key */
    uint32_t count, capacity;
    bool is_incomplete; /* memory was short while they were collected */
};

struct server_registry {
    struct server_store *store;
    struct server_budget *budget;
    struct server_workers *writer, *reader; /* of one thread each */
    pthread_mutex_t writing;
    pthread_rwlock_t lock;
    struct slots all;                                             /* under `lock` */
    void (*gone)(void *user, const struct server_record *record); /* or NULL */
    void *gone_user;
    atomic_uint_least64_t clock, loads, unloads;
    /* of a shared store: */
    pthread_mutex_t following;
    uint64_t seen; /* all changes up to this version are here; under `following` */
    atomic_uint_least64_t followed_ns; /* begin of the last following that succeeded */
    struct server_thread *follower;    /* NULL: the store is not shared */
};

/* --- slots, under the lock -------------------------------------------------------------------- */

static int slot_compare(const struct slot *slot, const struct server_key *key)
{
    const struct server_key own = server_record_key(slot->record);
    return server_key_compare(&own, key);
}

/* Index of the first slot whose key is not before `key`. The name "" is before all others. */
static uint32_t slots_lower_bound(const struct slots *all, const struct server_key *key)
{
    uint32_t low = 0, high = all->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (slot_compare(all->slots[middle], key) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static struct slot *slots_find(const struct slots *all, const struct server_key *key)
{
    uint32_t at = slots_lower_bound(all, key);
    return at < all->count && slot_compare(all->slots[at], key) == 0 ? all->slots[at] : NULL;
}

static struct slot *slots_find_record(const struct slots *all, const struct server_record *record)
{
    const struct server_key key = server_record_key(record);
    struct slot *slot = slots_find(all, &key);
    return slot && slot->record == record ? slot : NULL;
}

static int slot_compare_items(const void *a, const void *b)
{
    const struct slot *const *first = a, *const *second = b;
    const struct server_key key = server_record_key((*second)->record);
    return slot_compare(*first, &key);
}

/* Makes room for one more; false without memory. */
static bool slots_reserve(struct slots *all)
{
    if (all->count < all->capacity) return true;
    uint32_t capacity = all->capacity ? 2 * all->capacity : FIRST_CAPACITY;
    struct slot **slots = realloc(all->slots, capacity * sizeof(struct slot *));
    if (!slots) return false;
    all->slots = slots;
    all->capacity = capacity;
    return true;
}

/* Room was reserved. */
static void slots_insert(struct slots *all, struct slot *slot)
{
    const struct server_key key = server_record_key(slot->record);
    struct slot **at = all->slots + slots_lower_bound(all, &key);
    memmove(at + 1, at, (size_t)(all->slots + all->count++ - at) * sizeof *at);
    *at = slot;
}

/* Removes the slot of that key, which exists. */
static struct slot *slots_extract(struct slots *all, const struct server_key *key)
{
    struct slot **at = all->slots + slots_lower_bound(all, key), *slot = *at;
    memmove(at, at + 1, (size_t)(all->slots + --all->count - at) * sizeof *at);
    return slot;
}

static void slot_touch(struct server_registry *registry, struct slot *slot)
{
    atomic_store_explicit(&slot->turn,
                          atomic_fetch_add_explicit(&registry->clock, 1, memory_order_relaxed),
                          memory_order_relaxed);
    atomic_fetch_add_explicit(&slot->uses, 1, memory_order_relaxed);
    atomic_store_explicit(&slot->last, time(NULL), memory_order_relaxed);
}

static struct server_listed slot_share(const struct slot *slot)
{
    return (struct server_listed){server_record_retain(slot->record),
                                  slot->surface ? server_surface_retain(slot->surface) : NULL};
}

/* --- slots, without a lock -------------------------------------------------------------------- */

static struct slot *slot_create(struct server_record *record)
{
    struct slot *slot = calloc(1, sizeof *slot);
    if (slot) slot->record = server_record_retain(record);
    return slot;
}

static void surface_retire(struct server_surface *surface)
{
    if (!surface) return;
    server_surface_retire(surface);
    server_surface_release(surface);
}

/* Destroys a slot that has left, with its surface, and calls the watcher; NULL is harmless. */
static void slot_leave(struct server_registry *registry, struct slot *slot)
{
    if (!slot) return;
    surface_retire(slot->surface);
    if (registry->gone && !server_registry_holds(registry, slot->record->etag))
        registry->gone(registry->gone_user, slot->record);
    server_record_release(slot->record);
    free(slot);
}

/* Destroys a slot that was never inserted; its surface stays its maker's. */
static void slot_drop(struct slot *slot)
{
    server_record_release(slot->record);
    server_surface_release(slot->surface);
    free(slot);
}

static bool on_stored(void *user, const struct server_stored *stored)
{
    struct slots *all = user;
    struct slot *slot = slots_reserve(all) ? slot_create(stored->record) : NULL;
    all->is_incomplete |= !slot;
    if (!slot) return false;
    slot->uses = slot->noted = stored->uses.count;
    slot->last = stored->uses.last;
    slot->version = stored->version;
    all->slots[all->count++] = slot;
    return true;
}

/* Collects what the store holds; on failure `*all` has a part of it. */
static enum server_store_outcome slots_collect(struct server_registry *registry, struct slots *all)
{
    *all = (struct slots){0};
    enum server_store_outcome outcome = registry->store->each(registry->store, on_stored, all);
    for (uint32_t i = 0; i < all->count; i++)
        server_record_count(all->slots[i]->record, registry->budget);
    if (all->count) qsort(all->slots, all->count, sizeof(struct slot *), slot_compare_items);
    return !outcome && all->is_incomplete ? SERVER_STORE_NO_MEMORY : outcome;
}

/* --- memory ----------------------------------------------------------------------------------- */

static bool can_unload(const struct server_surface *surface)
{
    return surface && atomic_load(&surface->references) == 1;
}

/* Bytes of the surfaces that could be unloaded at this moment. */
static size_t slot_unloadable(void *user)
{
    struct server_registry *registry = user;
    size_t bytes = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count; i++) {
        const struct server_surface *surface = registry->all.slots[i]->surface;
        if (can_unload(surface)) bytes += surface->bytes;
    }
    pthread_rwlock_unlock(&registry->lock);
    return bytes;
}

/* Under the lock: the least recently used slot whose surface can be unloaded; or NULL. */
static struct slot *coldest_slot(const struct slots *all, bool without_fields)
{
    struct slot *coldest = NULL;
    for (uint32_t i = 0; i < all->count; i++) {
        struct slot *slot = all->slots[i];
        if (!can_unload(slot->surface) || (coldest && slot->turn >= coldest->turn)) continue;
        if (without_fields && server_mesh_cache_count(slot->surface->fields)) continue;
        coldest = slot;
    }
    return coldest;
}

static void surfaces_unload(struct server_registry *registry, size_t bytes, bool without_fields)
{
    for (size_t freed = 0; freed < bytes;) {
        pthread_rwlock_wrlock(&registry->lock);
        struct slot *slot = coldest_slot(&registry->all, without_fields);
        struct server_surface *surface = slot ? slot->surface : NULL;
        if (slot) slot->surface = NULL;
        pthread_rwlock_unlock(&registry->lock);
        if (!surface) return;
        freed += surface->bytes;
        surface_retire(surface);
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

void server_listed_release(struct server_listed *listed)
{
    server_surface_release(listed->surface);
    server_record_release(listed->record);
}

bool server_registry_holds(struct server_registry *registry, const char *etag)
{
    bool found = false;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count && !found; i++)
        found = strcmp(registry->all.slots[i]->record->etag, etag) == 0;
    pthread_rwlock_unlock(&registry->lock);
    return found;
}

bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct slot *slot = slots_find(&registry->all, key);
    if (slot) *out = slot_share(slot);
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out)
{
    pthread_rwlock_rdlock(&registry->lock);
    struct slot *slot = slots_find(&registry->all, key);
    if (slot) {
        slot_touch(registry, slot);
        *out = slot->surface ? server_surface_retain(slot->surface) : NULL;
    }
    pthread_rwlock_unlock(&registry->lock);
    return slot != NULL;
}

/* Index of the first slot after `key`. */
static uint32_t slots_after(const struct slots *all, const struct server_key *key)
{
    return slots_lower_bound(all, key) + (slots_find(all, key) != NULL);
}

uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              const char *prefix, uint32_t most, struct server_listed *out)
{
    const char *name = after->name ? after->name : "", *begin = prefix ? prefix : "";
    const struct server_key from = {after->tenant, after->kind, name};
    const struct server_key first = {after->tenant, after->kind, begin};
    const struct slots *all = &registry->all;
    uint32_t listed = 0;
    pthread_rwlock_rdlock(&registry->lock);
    /* In byte order the names that begin with `begin` follow each other. */
    uint32_t at =
        strcmp(name, begin) < 0 ? slots_lower_bound(all, &first) : slots_after(all, &from);
    for (; listed < most && at < all->count; at++) {
        const struct server_record *record = all->slots[at]->record;
        if (record->kind != from.kind || strcmp(record->tenant, from.tenant) != 0 ||
            strncmp(record->name, begin, strlen(begin)) != 0)
            break;
        out[listed++] = slot_share(all->slots[at]);
    }
    pthread_rwlock_unlock(&registry->lock);
    return listed;
}

bool server_registry_next(struct server_registry *registry, struct server_listed *listed)
{
    const struct slots *all = &registry->all;
    struct server_listed before = *listed;
    struct server_key key;
    *listed = (struct server_listed){0};
    if (before.record) key = server_record_key(before.record);
    pthread_rwlock_rdlock(&registry->lock);
    uint32_t at = before.record ? slots_after(all, &key) : 0;
    if (at < all->count) *listed = slot_share(all->slots[at]);
    pthread_rwlock_unlock(&registry->lock);
    server_listed_release(&before);
    return listed->record != NULL;
}

struct server_registry_statistics server_registry_statistics(struct server_registry *registry)
{
    struct server_registry_statistics statistics = {.loads = registry->loads,
                                                    .unloads = registry->unloads};
    if (registry->store->damaged) statistics.damaged = registry->store->damaged(registry->store);
    pthread_rwlock_rdlock(&registry->lock);
    statistics.surfaces = registry->all.count;
    for (uint32_t i = 0; i < registry->all.count; i++)
        statistics.loaded += registry->all.slots[i]->surface != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return statistics;
}

const char *server_registry_health(struct server_registry *registry)
{
    return registry->store->health(registry->store);
}

/* --- loading and uses ------------------------------------------------------------------------- */

struct server_store *server_registry_store(const struct server_registry *registry)
{
    return registry->store;
}

void server_registry_keep(struct server_registry *registry, struct server_surface *surface)
{
    pthread_rwlock_wrlock(&registry->lock);
    struct slot *slot = slots_find_record(&registry->all, surface->record);
    if (slot && !slot->surface) {
        slot->surface = server_surface_retain(surface);
        atomic_fetch_add(&registry->loads, 1);
    }
    pthread_rwlock_unlock(&registry->lock);
}

struct server_record *server_registry_hottest(struct server_registry *registry)
{
    struct slot *hottest = NULL;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count; i++) {
        struct slot *slot = registry->all.slots[i];
        if (slot->surface || slot->was_tried) continue;
        if (!hottest || slot->uses > hottest->uses ||
            (slot->uses == hottest->uses && slot->last > hottest->last))
            hottest = slot;
    }
    if (hottest) atomic_store(&hottest->was_tried, true);
    struct server_record *record = hottest ? server_record_retain(hottest->record) : NULL;
    pthread_rwlock_unlock(&registry->lock);
    return record;
}

/* Under the writer lock, which keeps the records: collects up to NOTED_AT_ONCE changed uses. */
static uint32_t slots_collect_uses(struct server_registry *registry,
                                   const struct server_record **records,
                                   struct server_store_uses *uses)
{
    uint32_t count = 0;
    pthread_rwlock_rdlock(&registry->lock);
    for (uint32_t i = 0; i < registry->all.count && count < NOTED_AT_ONCE; i++) {
        struct slot *slot = registry->all.slots[i];
        uint64_t now = atomic_load(&slot->uses);
        if (now == slot->noted) continue;
        slot->noted = now;
        records[count] = slot->record;
        uses[count++] = (struct server_store_uses){now, atomic_load(&slot->last)};
    }
    pthread_rwlock_unlock(&registry->lock);
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
        if (count) registry->store->note_uses(registry->store, records, uses, count);
        pthread_mutex_unlock(&registry->writing);
    } while (count == NOTED_AT_ONCE);
}

/* --- following a shared store ----------------------------------------------------------------- */

/* Under the slots' lock: applies a change, unless this daemon made it itself; `*left` is the slot
 * that it replaces or removes. False without memory. */
static bool change_apply(struct server_registry *registry, const struct server_key *key,
                         const struct server_store_change *change, struct slot **left)
{
    struct slot *before = slots_find(&registry->all, key), *after = NULL;
    if (before && before->version >= change->version) return true;
    if (change->record) {
        after = slots_reserve(&registry->all) ? slot_create(change->record) : NULL;
        if (!after) return false;
        server_record_count(change->record, registry->budget);
        after->version = change->version;
    }
    if (before) *left = slots_extract(&registry->all, key);
    if (before && after) {
        after->uses = before->uses;
        after->noted = before->noted;
        after->last = before->last;
        after->was_tried = before->was_tried;
    }
    if (after) slots_insert(&registry->all, after);
    return true;
}

static bool on_change(void *user, const struct server_store_change *change)
{
    struct server_registry *registry = user;
    struct slot *left = NULL;
    struct server_key key;
    char text[SERVER_KEY_TEXT];
    if (strlen(change->key) >= sizeof text) return true;
    strcpy(text, change->key);
    if (!server_key_read(text, &key)) return true; /* of a later version of this program */
    pthread_rwlock_wrlock(&registry->lock);
    bool is_applied = change_apply(registry, &key, change, &left);
    pthread_rwlock_unlock(&registry->lock);
    if (is_applied) registry->seen = change->version;
    slot_leave(registry, left);
    return is_applied;
}

/* Exchanges the slots whose version did not change, so that their surfaces stay in memory. */
static void keep_unchanged(struct slots *all, struct slots *fresh)
{
    for (uint32_t i = 0; i < fresh->count; i++) {
        const struct server_key key = server_record_key(fresh->slots[i]->record);
        struct slot *slot = slots_find(all, &key);
        if (!slot || slot->version != fresh->slots[i]->version) continue;
        all->slots[slots_lower_bound(all, &key)] = fresh->slots[i];
        fresh->slots[i] = slot;
    }
}

/* Reads all of the store again: it no longer knows what was changed, after a long absence or when a
 * backup was restored. */
static enum server_store_outcome registry_reread(struct server_registry *registry)
{
    struct slots fresh;
    enum server_store_outcome outcome = slots_collect(registry, &fresh);
    if (!outcome) {
        pthread_rwlock_wrlock(&registry->lock);
        keep_unchanged(&registry->all, &fresh);
        struct slots before = registry->all;
        registry->all = fresh;
        fresh = before;
        pthread_rwlock_unlock(&registry->lock);
        registry->seen = 0; /* the slots are not of one moment: each version is compared */
    }
    for (uint32_t i = 0; i < fresh.count; i++) slot_leave(registry, fresh.slots[i]);
    free(fresh.slots);
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
    if (!server_registry_is_shared(registry)) return outcome;
    pthread_mutex_lock(&registry->following);
    if (atomic_load(&registry->followed_ns) <= since_ns) {
        uint64_t begun_ns = gd_now_ns();
        outcome = registry->store->follow(registry->store, on_change, registry);
        if (outcome == SERVER_STORE_STALE) outcome = registry_reread(registry);
        if (!outcome) atomic_store(&registry->followed_ns, begun_ns);
    }
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
    bool is_known = slots_find(&registry->all, key) != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return is_known;
}

bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record)
{
    (void)server_registry_follow(registry, gd_now_ns());
    pthread_rwlock_rdlock(&registry->lock);
    bool is_current = slots_find_record(&registry->all, record) != NULL;
    pthread_rwlock_unlock(&registry->lock);
    return is_current;
}

static void follow_changes(void *user, struct server_thread *thread)
{
    struct server_registry *registry = user;
    while (server_thread_pause(thread, 0)) {
        registry->store->await(registry->store, AWAIT_NS);
        (void)server_registry_follow(registry, gd_now_ns());
    }
}

/* --- putting and removing --------------------------------------------------------------------- */

/* What a change rests on: the surface of the key, retained, or all zero. Another daemon may change
 * it at any time, this one can't. */
struct basis {
    struct server_listed now;
    uint64_t version;
};

static struct basis basis_find(struct server_registry *registry, const struct server_key *key)
{
    struct basis basis = {0};
    pthread_rwlock_rdlock(&registry->lock);
    const struct slot *slot = slots_find(&registry->all, key);
    if (slot) basis = (struct basis){slot_share(slot), slot->version};
    pthread_rwlock_unlock(&registry->lock);
    return basis;
}

/* Under the follower's and the slots' lock: true when the change of this daemon with that version
 * (0: the store is not shared) is not in the slots yet, and nothing later is. */
static bool is_news(const struct server_registry *registry, const struct slot *slot,
                    uint64_t version)
{
    return !version || (version > registry->seen && (!slot || slot->version < version));
}

/* A slot for a surface, with room for it. NULL without memory. */
static struct slot *slot_prepare(struct server_registry *registry, struct server_surface *surface)
{
    pthread_rwlock_wrlock(&registry->lock);
    bool has_room = slots_reserve(&registry->all);
    pthread_rwlock_unlock(&registry->lock);
    struct slot *slot = has_room ? slot_create(surface->record) : NULL;
    if (!slot) return NULL;
    slot->surface = server_surface_retain(surface);
    slot_touch(registry, slot);
    return slot;
}

/* Inserts a slot that is stored; `*left` is the one that it replaces. */
static void slot_enter(struct server_registry *registry, struct slot *slot, struct slot **left)
{
    const struct server_key key = server_record_key(slot->record);
    pthread_mutex_lock(&registry->following);
    pthread_rwlock_wrlock(&registry->lock);
    struct slot *found = slots_find(&registry->all, &key);
    bool follower_was_quicker = found && found->version && found->version == slot->version;
    bool enters = follower_was_quicker || is_news(registry, found, slot->version);
    if (enters && found) *left = slots_extract(&registry->all, &key);
    if (enters && slots_reserve(&registry->all))
        slots_insert(&registry->all, slot);
    else
        slot_drop(slot);
    pthread_rwlock_unlock(&registry->lock);
    pthread_mutex_unlock(&registry->following);
}

/* A put on its way. */
struct put {
    struct server_surface *surface;
    struct server_content content;
    const struct server_precondition *precondition; /* NULL: the key has to have this record */
    struct slot *left;                              /* the slot that it replaced */
};

static enum server_store_outcome surface_put_record(struct server_registry *registry,
                                                    struct put *put, uint64_t version)
{
    struct slot *slot = slot_prepare(registry, put->surface);
    if (!slot) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome =
        registry->store->put(registry->store, slot->record, &put->content, &version);
    if (outcome) {
        slot_drop(slot);
        return outcome;
    }
    slot->version = version;
    slot_enter(registry, slot, &put->left);
    return SERVER_STORE_DONE;
}

/* Under the writer lock. STALE: another daemon was quicker. */
static enum server_store_outcome surface_put_once(struct server_registry *registry, struct put *put)
{
    struct server_store *store = registry->store;
    struct server_record *record = put->surface->record;
    const struct server_key key = server_record_key(record);
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    if (store->stage) outcome = store->stage(store, record, &put->content);
    if (!outcome) outcome = server_registry_follow(registry, gd_now_ns());
    if (outcome) return outcome;
    struct basis basis = basis_find(registry, &key);
    bool exists = basis.now.record, is_same = basis.now.record == record;
    if (!put->precondition && !is_same)
        outcome = SERVER_STORE_ABSENT;
    else if (put->precondition &&
             !server_precondition_holds(put->precondition, exists ? basis.now.record->etag : NULL))
        outcome = SERVER_STORE_PRECONDITION;
    else if (is_same)
        outcome = store->keep(store, record, &put->content);
    else
        outcome = surface_put_record(registry, put, basis.version);
    server_listed_release(&basis.now);
    if (outcome) return outcome;
    if (is_same) server_registry_keep(registry, put->surface);
    return exists ? SERVER_STORE_REPLACED : SERVER_STORE_CREATED;
}

enum server_store_outcome server_registry_put(struct server_registry *registry,
                                              struct server_surface *surface, const void *bytes,
                                              const struct server_precondition *precondition)
{
    struct put put = {
        .surface = surface,
        .content =
            {.parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = surface->attachment}},
        .precondition = precondition};
    enum server_store_outcome outcome = SERVER_STORE_STALE;
    if (!server_record_take(surface->record, registry->budget)) return SERVER_STORE_NO_MEMORY;
    pthread_mutex_lock(&registry->writing);
    for (int i = 0; i < ATTEMPTS && outcome == SERVER_STORE_STALE; i++)
        outcome = surface_put_once(registry, &put);
    if (outcome == SERVER_STORE_CREATED || outcome == SERVER_STORE_REPLACED)
        registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    slot_leave(registry, put.left);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_UNAVAILABLE : outcome;
}

/* Under the writer lock; `*left` is the removed slot. STALE: another daemon was quicker. */
static enum server_store_outcome surface_remove_once(struct server_registry *registry,
                                                     const struct server_key *key,
                                                     const struct server_precondition *precondition,
                                                     struct slot **left)
{
    enum server_store_outcome outcome = server_registry_follow(registry, gd_now_ns());
    if (outcome) return outcome;
    struct basis basis = basis_find(registry, key);
    if (!basis.now.record) return SERVER_STORE_ABSENT;
    outcome = server_precondition_holds(precondition, basis.now.record->etag)
                  ? registry->store->remove(registry->store, basis.now.record, &basis.version)
                  : SERVER_STORE_PRECONDITION;
    server_listed_release(&basis.now);
    if (outcome) return outcome;
    pthread_mutex_lock(&registry->following);
    pthread_rwlock_wrlock(&registry->lock);
    const struct slot *found = slots_find(&registry->all, key);
    if (found && is_news(registry, found, basis.version))
        *left = slots_extract(&registry->all, key);
    pthread_rwlock_unlock(&registry->lock);
    pthread_mutex_unlock(&registry->following);
    return SERVER_STORE_DONE;
}

enum server_store_outcome server_registry_remove(struct server_registry *registry,
                                                 const struct server_key *key,
                                                 const struct server_precondition *precondition)
{
    struct slot *left = NULL;
    enum server_store_outcome outcome = SERVER_STORE_STALE;
    pthread_mutex_lock(&registry->writing);
    for (int i = 0; i < ATTEMPTS && outcome == SERVER_STORE_STALE; i++)
        outcome = surface_remove_once(registry, key, precondition, &left);
    if (outcome == SERVER_STORE_DONE) registry->store->tidy(registry->store);
    pthread_mutex_unlock(&registry->writing);
    slot_leave(registry, left);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_UNAVAILABLE : outcome;
}

/* --- jobs ------------------------------------------------------------------------------------- */

void server_registry_submit(struct server_registry *registry, struct server_job *job)
{
    (void)server_workers_submit(registry->writer, job); /* its queue is never full */
}

void server_registry_submit_list(struct server_registry *registry, struct server_job *job)
{
    (void)server_workers_submit(registry->reader, job); /* its queue is never full */
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

void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record), void *user)
{
    registry->gone = gone;
    registry->gone_user = user;
}

/* --- life ------------------------------------------------------------------------------------- */

static bool registry_start(struct server_registry *registry)
{
    registry->writer = server_workers_create(1, UINT32_MAX);
    registry->reader = server_workers_create(1, UINT32_MAX);
    if (!registry->writer || !registry->reader || slots_collect(registry, &registry->all))
        return false;
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
    if (!registry_start(registry)) {
        server_registry_destroy(registry);
        return NULL;
    }
    if (!store->fetch) return registry; /* what is unloaded would be lost */
    budget->reclaimers[SERVER_RECLAIM_IDLE] =
        (struct server_reclaimer){unload_idle, NULL, registry};
    budget->reclaimers[SERVER_RECLAIM_MESHES] =
        (struct server_reclaimer){unload_any, slot_unloadable, registry};
    return registry;
}

void server_registry_destroy(struct server_registry *registry)
{
    if (!registry) return;
    server_thread_stop(registry->follower);
    server_workers_destroy(registry->writer);
    server_workers_destroy(registry->reader);
    registry->budget->reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){0};
    registry->budget->reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){0};
    registry->gone = NULL;
    for (uint32_t i = 0; i < registry->all.count; i++) slot_leave(registry, registry->all.slots[i]);
    registry->store->close(registry->store);
    pthread_rwlock_destroy(&registry->lock);
    pthread_mutex_destroy(&registry->following);
    pthread_mutex_destroy(&registry->writing);
    free(registry->all.slots);
    free(registry);
}
