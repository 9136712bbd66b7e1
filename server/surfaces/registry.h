/* Registry: all surfaces by key (kind.h), whether in memory or loaded on demand.
 *
 * DESIGN. The registry has slots, sorted by key. A slot holds a record, and the surface while that
 * is in memory. A change holds the writer lock until the store has made it durable, so that
 * preconditions are checked together with the write. A reader-writer lock guards the slots. Threads
 * hold it only briefly, so readers never wait for the disk. Order of locks: writer, follower,
 * slots. Surfaces are retired and released without the slots' lock, because that frees fields.
 *
 * Shared store: a thread applies the changes of other daemons to the slots, under the follower's
 * lock, when the database signals a change and every 200 ms. If the daemon last asked for changes
 * more than a second ago, or the name is unknown (server_registry_is_fresh), a worker applies the
 * changes before it handles the request. So, while the store can be reached, no answer uses a
 * surface that was replaced or removed more than a second before.
 *
 * When memory is short, unused surfaces are unloaded if the store can load them again. Surfaces
 * without cached fields are unloaded first, in the order of their last use. Then fields are evicted
 * (cache.h). Then any other unused surface is unloaded. All functions are thread-safe. */
#pragma once

#include "server/exchange/etag.h"
#include "server/store/store.h"
#include "server/surfaces/surface.h"

struct server_registry;

/* Creates a registry. Lists the surfaces of the store, but loads none. The registry owns the store,
 * borrows the budget and registers as its reclaimer. If there is no memory or no thread, closes the
 * store and returns NULL. */
struct server_registry *server_registry_create(struct server_store *store,
                                               struct server_budget *budget);
void server_registry_destroy(struct server_registry *registry); /* NULL is allowed */

/* Registers `gone`, which is called without a lock when a record has left the registry and no other
 * record has its ETag. Call this function before the first change. */
void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record),
                           void *user);

/* Both functions wait for the disk. server_registry_put durably stores a surface under its record's
 * key, with its attachment and the file from which it was made (`bytes`, borrowed). Returns CREATED
 * or REPLACED. If the key already has this record, the function keeps the surface in memory,
 * repairs damaged stored bytes, and returns REPLACED. If the precondition is NULL and the key has
 * another record or no record, the function stores nothing and returns ABSENT. Errors:
 * PRECONDITION, NO_MEMORY, FULL, REFUSED, READ_ONLY, UNAVAILABLE. server_registry_remove returns
 * DONE, ABSENT or one of these errors. */
enum server_outcome server_registry_put(struct server_registry *registry,
                                        struct server_surface *surface, const void *bytes,
                                        const struct server_precondition *precondition);
enum server_outcome server_registry_remove(struct server_registry *registry,
                                           const struct server_key *key,
                                           const struct server_precondition *precondition);

/* Changes the caption of that surface durably. Its cached fields remain. Returns DONE, ABSENT or an
 * error of server_registry_put. */
enum server_outcome server_registry_caption(struct server_registry *registry,
                                            const struct server_key *key, const char *caption,
                                            const struct server_precondition *precondition);

/* Returns true if the preconditions allow a change of that record; NULL means that there is no
 * record. */
bool server_registry_allows(const struct server_precondition *precondition,
                            const struct server_record *record);

/* Returns true if a record with that ETag exists. O(records). */
bool server_registry_holds(struct server_registry *registry, const char *etag);

/* Finds and retains the record of that key, and the surface if it is in memory. Returns false if
 * there is none. */
bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out);

/* Sets `*out` to the surface of that key, retained, or to NULL if the surface is not in memory.
 * Counts a use. Returns false if there is no such key. */
bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out);

/* Lists up to `most` surfaces of the tenant and kind of `after`, in byte order of names. Each
 * surface is retained. Their names are after the name in `after` (NULL means all) and begin with
 * `prefix` (NULL means any). Returns their number. */
uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              const char *prefix, uint32_t most, struct server_listed *out);

/* Visits all surfaces in the order of their keys, each retained until the next call:
 *
 *     struct server_listed listed = {0};
 *     while (server_registry_next(registry, &listed)) ...
 *
 * A loop that ends early releases `listed`. It may release listed.surface and set it to NULL. */
bool server_registry_next(struct server_registry *registry, struct server_listed *listed);

/* Returns true if other daemons also write to the store. */
bool server_registry_is_shared(const struct server_registry *registry);

/* Returns true if the slots are current enough for this key, or, if it is NULL, for all keys; see
 * DESIGN. */
bool server_registry_is_fresh(struct server_registry *registry, const struct server_key *key);

/* Applies the changes that other daemons made up to `since_ns`, unless they are already applied.
 * HTTP threads must not call this function. Returns DONE (also if the store is not shared),
 * UNAVAILABLE or NO_MEMORY. */
enum server_outcome server_registry_follow(struct server_registry *registry, uint64_t since_ns);

/* Returns true if the key still has this record. First applies changes of a shared store. The store
 * removes bytes only after the registry has dropped the record. So if bytes are missing and this
 * function then returns true, the store is damaged. */
bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record);

/* Returns the registry's store, for `fetch` and `verify` (store.h). */
struct server_store *server_registry_store(const struct server_registry *registry);

/* Stores a loaded surface in its slot, unless the key has another record or another surface. */
void server_registry_keep(struct server_registry *registry, struct server_surface *surface);

/* Returns the record of the most used surface that is not in memory, retained, or NULL. Returns
 * each record only once. */
struct server_record *server_registry_hottest(struct server_registry *registry);

/* Stores the numbers of uses that have changed since the last call. */
void server_registry_note_uses(struct server_registry *registry);

struct server_registry_statistics {
    uint64_t surfaces, loaded, loads, unloads, damaged; /* `damaged` files are in quarantine */
};
struct server_registry_statistics server_registry_statistics(struct server_registry *registry);

/* Returns a sentence with the reason why the store can't write; NULL means that it can. */
const char *server_registry_health(struct server_registry *registry);
