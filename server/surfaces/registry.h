/* Registry: the surfaces by key (kind.h), those in memory and those that can be loaded.
 *
 * DESIGN. Slots, sorted by key, have a record, and the surface while that is in memory. A change
 * holds the writer lock until the store has made it durable: so preconditions are checked together
 * with the write. The slots have a reader-writer lock that is held for moments only: readers never
 * wait for the disk. Order of locks: writer, follower, slots. Surfaces are retired and released
 * without the slots' lock, since that frees fields.
 *
 * Shared store: a thread applies the changes of other daemons to the slots, under the follower's
 * lock: when the database signals a change, and every 200 ms. A request has a worker follow first
 * if the last following is older than a second or the name is unknown (server_registry_is_fresh),
 * unless the store is out of reach. So, while the store is in reach, no answer rests on a surface
 * that was replaced or removed more than a second before.
 *
 * Under memory pressure unused surfaces are unloaded if the store can load them again: first those
 * without cached fields, the least recently used first; then fields go (cache.h); then any unused
 * surface. All functions are thread-safe. */
#ifndef SERVER_SURFACES_REGISTRY_H
#define SERVER_SURFACES_REGISTRY_H

#include "server/exchange/etag.h"
#include "server/store/store.h"
#include "server/surfaces/surface.h"

struct server_registry;

/* Lists what the store holds, loads nothing. The registry owns the store and becomes a reclaimer of
 * the budget, which is borrowed. NULL without memory or thread: then the store is closed. */
struct server_registry *server_registry_create(struct server_store *store,
                                               struct server_budget *budget);
void server_registry_destroy(struct server_registry *registry); /* NULL is harmless */

/* Has `gone` called, without any lock, when a record has left and no other has its ETag. Before the
 * first change. */
void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record),
                           void *user);

/* Both wait for the disk. put stores a surface under its record's key, durably, with its attachment
 * and `bytes`, the file that it was made from (borrowed): CREATED or REPLACED. If the key has this
 * record already, the surface is kept in memory and its stored bytes are repaired if need be:
 * REPLACED. Without a precondition (NULL) only that is done, and ABSENT means that the key has
 * another record or none. Else PRECONDITION, NO_MEMORY, FULL, REFUSED, READ_ONLY, UNAVAILABLE;
 * remove: DONE, ABSENT or one of these. */
enum server_store_outcome server_registry_put(struct server_registry *registry,
                                              struct server_surface *surface, const void *bytes,
                                              const struct server_precondition *precondition);
enum server_store_outcome server_registry_remove(struct server_registry *registry,
                                                 const struct server_key *key,
                                                 const struct server_precondition *precondition);

struct server_listed {
    struct server_record *record;
    struct server_surface *surface; /* NULL: not in memory */
};
void server_listed_release(struct server_listed *listed); /* all zero is harmless */

/* True when a record has that ETag. Time linear in the number of records. */
bool server_registry_holds(struct server_registry *registry, const char *etag);

/* The surface of that key, record and surface retained; false: there is none. */
bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out);

/* The surface of that key if it is in memory (else NULL), retained; counts a use. False: there is
 * no such key. */
bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out);

/* Up to `most` surfaces of the tenant and kind of `after`, with names after its name (NULL: all)
 * that begin with `prefix` (NULL: any), in byte order, each retained; returns how many. */
uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              const char *prefix, uint32_t most, struct server_listed *out);

/* All surfaces in the order of their keys, each retained until the next call:
 *
 *     struct server_listed listed = {0};
 *     while (server_registry_next(registry, &listed)) ...
 *
 * A loop that ends before releases `listed`. It may release listed.surface and set it to NULL. */
bool server_registry_next(struct server_registry *registry, struct server_listed *listed);

/* True when other daemons write to the store, too. */
bool server_registry_is_shared(const struct server_registry *registry);

/* True when the slots may answer for this key (NULL: for all): see DESIGN. */
bool server_registry_is_fresh(struct server_registry *registry, const struct server_key *key);

/* Applies the changes of other daemons up to `since_ns`, unless that is done. Not in threads of
 * HTTP. DONE, also if the store is not shared; UNAVAILABLE, NO_MEMORY. */
enum server_store_outcome server_registry_follow(struct server_registry *registry,
                                                 uint64_t since_ns);

/* True when the record still is its key's; follows a shared store first. The store removes bytes
 * only after the registry has dropped the record: so bytes are missing by a fault if this is true
 * afterwards. */
bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record);

/* The store that the registry owns, to fetch from and to verify (store.h). */
struct server_store *server_registry_store(const struct server_registry *registry);

/* Keeps a loaded surface in memory if its record still is its key's and no other thread was
 * quicker. */
void server_registry_keep(struct server_registry *registry, struct server_surface *surface);

/* The record of the surface that was used most of those not in memory, retained; NULL: there is
 * none. Returns each record once. */
struct server_record *server_registry_hottest(struct server_registry *registry);

/* Stores how often surfaces were used, where that has changed since the last time. */
void server_registry_note_uses(struct server_registry *registry);

struct server_registry_statistics {
    uint64_t surfaces, loaded, loads, unloads, damaged; /* damaged: files in quarantine */
};
struct server_registry_statistics server_registry_statistics(struct server_registry *registry);

/* Why nothing can be written, a sentence; NULL: all is well. */
const char *server_registry_health(struct server_registry *registry);

#endif
