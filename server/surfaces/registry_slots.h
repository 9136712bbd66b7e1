/* Slots: the inside of the registry, which its readers (registry.c), its writers
 * (registry_writing.c) and its follower (registry_following.c) share. See registry.h. */
#ifndef SERVER_SURFACES_REGISTRY_SLOTS_H
#define SERVER_SURFACES_REGISTRY_SLOTS_H

#include <pthread.h>
#include <stdatomic.h>

#include "server/surfaces/registry.h"
#include "server/base/thread.h"

struct server_slot {
    struct server_record *record;
    struct server_surface *surface; /* NULL: not in memory */
    atomic_uint_least64_t uses;
    atomic_int_least64_t last;  /* seconds since 1970 */
    atomic_uint_least64_t turn; /* of the registry's clock, when it was used last */
    uint64_t noted;             /* uses that the store knows; under the writer lock */
    uint64_t version;           /* of a shared store: what the record is; under the slots' lock */
    atomic_bool was_tried;      /* to be loaded before anybody asked */
};

struct server_registry {
    struct server_store *store;
    struct server_budget *budget;
    struct server_workers *writer; /* of one thread */
    struct server_workers *reader; /* of one thread, which makes lists */
    pthread_mutex_t writing;
    pthread_rwlock_t lock;
    struct server_slot **slots; /* sorted by key */
    uint32_t count, capacity;
    void (*gone)(void *user, const struct server_record *record); /* NULL: nobody wants to know */
    void *gone_user;
    bool is_incomplete; /* the store has more than memory could be had for */
    atomic_uint_least64_t clock, loads, unloads;
    /* of a shared store: */
    pthread_mutex_t following;
    /* up to this version all changes are here; under the follower's lock */
    uint64_t seen;
    atomic_uint_least64_t followed_ns; /* when the last following that succeeded began */
    struct server_thread *follower;    /* NULL: the store is not shared */
};

/* --- under the lock --------------------------------------------------------------------------- */

/* Index of the first slot whose key is not before `key`. The key's name may be "", which is before
 * all others. O(log n). */
uint32_t server_slots_lower_bound(const struct server_registry *registry,
                                  const struct server_key *key);

/* NULL: there is none of that key. O(log n). */
struct server_slot *server_slots_find(const struct server_registry *registry,
                                      const struct server_key *key);

/* Puts slots that were added in any order into theirs. O(n log n). */
void server_slots_sort(struct server_registry *registry);

/* Makes room for one more; false without memory. */
bool server_slots_reserve(struct server_registry *registry);

/* Room was reserved. O(n). */
void server_slots_insert(struct server_registry *registry, struct server_slot *slot);

/* Takes out the slot of that key, which there is. O(n). */
struct server_slot *server_slots_extract(struct server_registry *registry,
                                         const struct server_key *key);

/* Adds what the store has as a slot at the end; to be sorted. False without memory. */
bool server_slots_append(struct server_registry *registry, const struct server_stored *stored);

/* Counts a use, now. */
void server_slot_touch(struct server_registry *registry, struct server_slot *slot);

/* --- the follower (registry_following.c) ------------------------------------------------------ */

/* Starts it, or stops it, if the store is shared. */
bool server_slots_start_follower(struct server_registry *registry);
void server_slots_stop_follower(struct server_registry *registry);

/* --- without any lock ------------------------------------------------------------------------- */

/* A slot that stands nowhere as yet, without a surface; the record is retained. NULL without
 * memory. */
struct server_slot *server_slot_create(struct server_record *record);
void server_slot_destroy(struct server_slot *slot); /* its surface is retired; NULL is harmless */

/* Tells who watches (server_registry_watch) that a record has left. */
void server_slots_tell(struct server_registry *registry, const struct server_record *record);

/* Retires and releases a surface that has left its slot; NULL is harmless. */
void server_slot_retire(struct server_surface *surface);

#endif
