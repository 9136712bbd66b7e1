/* Registry: the surfaces by key (key.h), those in memory and those that can be loaded.
 *
 * DESIGN. An array of slots sorted by key. A slot has a record, and the surface while it is in
 * memory. What a key is changes under the writer lock, which is held while the store makes the
 * change durable: so conditions are decided together with the write. The slots change under a
 * reader-writer lock that is held for moments only: so reading never waits for the disk. Who writes
 * waits for it, and for those who wrote before: no worker has time for that, so the registry has a
 * thread of its own, its writer, which runs the jobs that put or remove. A second one, its reader,
 * runs the jobs that make lists. Order: writer lock, then slots. Surfaces are retired and released
 * after the slots' lock is given up, since that frees fields.
 *
 * A store that other daemons share is followed by a thread, which brings what they change into the
 * slots, under the follower's lock (order: writer, follower, slots): as soon as the database tells,
 * and every 200 ms in any case. A request that comes when the last following is older than a
 * second, or whose name is not known, has a worker follow first (server_registry_is_fresh), unless
 * the store is out of reach: so, while it is in reach, nothing is answered from what was replaced
 * or removed more than a second before. What this daemon changes itself comes into the slots when
 * it is durable.
 *
 * Under the memory budget, surfaces that nobody uses are unloaded, if the store can load them
 * again: first those without cached fields, the least recently used first; then fields go
 * (cache.h); then any unused surface. */
#ifndef SERVER_SURFACES_REGISTRY_H
#define SERVER_SURFACES_REGISTRY_H

#include "server/http/etag.h"
#include "server/store/store.h"
#include "server/surfaces/surface.h"
#include "server/work/workers.h"

struct server_registry;

/* With what the store holds, nothing of it loaded, and its writer and its reader started. The store
 * becomes the registry's; the budget, whose reclaimers it becomes part of, is borrowed. NULL
 * without memory or thread: the store is closed. */
struct server_registry *server_registry_create(struct server_store *store,
                                               struct server_budget *budget);
void server_registry_destroy(struct server_registry *registry); /* NULL is harmless */

/* --- writing: by jobs of the registry's writer ------------------------------------------------ */

/* Has the writer run a job, which ends as job.h says. In the order in which they come, however
 * many: whoever admits requests has admitted them. */
void server_registry_submit(struct server_registry *registry, struct server_job *job);

/* Has a job run that makes a list, of whatever: by a thread of its own, so that lists neither keep
 * an HTTP thread nor wait for long work. In the order in which they come, however many; they are
 * short, so the daemon's drain waits for them. */
void server_registry_submit_list(struct server_registry *registry, struct server_job *job);

/* Refuses the jobs that are late; all of them, and those that come. */
void server_registry_expire(struct server_registry *registry, uint64_t now_ns);
void server_registry_cancel(struct server_registry *registry);

/* Has `gone` called, without any lock, when a record has left and no other has its content (its
 * ETag). To be set before anything is put. */
void server_registry_watch(struct server_registry *registry,
                           void (*gone)(void *user, const struct server_record *record),
                           void *user);

/* Puts a surface under its record's key, durably, together with the bytes of the file that it was
 * made from (borrowed) and its attachment: CREATED or REPLACED. If the key has this very record
 * already, the surface is only kept in memory and its bytes are made sure of: REPLACED. Else
 * PRECONDITION, NO_MEMORY, FULL, REFUSED, READ_ONLY, UNAVAILABLE. */
enum server_store_outcome server_registry_put(struct server_registry *registry,
                                              struct server_surface *surface, const void *bytes,
                                              const struct server_precondition *precondition);

/* Makes sure that the bytes that a surface was made from are stored, and whole: REPLACED; ABSENT:
 * its record is not, or no longer, the key's. Else as for a put. */
enum server_store_outcome server_registry_confirm(struct server_registry *registry,
                                                  const struct server_surface *surface,
                                                  const void *bytes);

/* DONE, ABSENT, PRECONDITION, FULL, REFUSED, READ_ONLY, UNAVAILABLE. */
enum server_store_outcome server_registry_remove(struct server_registry *registry,
                                                 const struct server_key *key,
                                                 const struct server_precondition *precondition);

/* --- reading ---------------------------------------------------------------------------------- */

struct server_listed {
    struct server_record *record;
    struct server_surface *surface; /* NULL: not in memory */
};
void server_listed_release(struct server_listed *listed);

/* True when a record has that ETag. Time linear in the number of records. */
bool server_registry_holds(struct server_registry *registry, const char *etag);

/* The surface of that key, its parts retained; false: there is none. */
bool server_registry_find(struct server_registry *registry, const struct server_key *key,
                          struct server_listed *out);

/* True when what the registry says of the key (NULL: of all) can be told as it is: nobody else
 * writes to the store, or it has been followed a moment ago and the key is known, or it is out of
 * reach. */
bool server_registry_is_fresh(struct server_registry *registry, const struct server_key *key);

/* Learns what other daemons have changed before `since_ns`, if it has not been learnt already; not
 * by threads that speak HTTP. DONE, also when nobody else writes; UNAVAILABLE, NO_MEMORY. */
enum server_store_outcome server_registry_follow(struct server_registry *registry,
                                                 uint64_t since_ns);

/* Do other daemons write to the store, too? */
bool server_registry_is_shared(const struct server_registry *registry);

/* Is the record its key's still? A shared store is followed first. Bytes go only after the registry
 * has forgotten their record (store.h): when they are missed and this is true, asked afterwards,
 * they are missing indeed. */
bool server_registry_is_current(struct server_registry *registry,
                                const struct server_record *record);

/* The surface of that key, if it is in memory (else NULL), with a reference for the caller; its use
 * is counted. False: there is no such key. */
bool server_registry_use(struct server_registry *registry, const struct server_key *key,
                         struct server_surface **out);

/* Up to `most` of the tenant and kind of `after`, with names after its name (NULL: from the first),
 * in byte order, each retained; returns how many. */
uint32_t server_registry_list(struct server_registry *registry, const struct server_key *after,
                              uint32_t most, struct server_listed *out);

/* The same of all tenants and kinds, in the order of their keys; `after` NULL: from the first. */
uint32_t server_registry_list_all(struct server_registry *registry, const struct server_key *after,
                                  uint32_t most, struct server_listed *out);

/* --- loading ---------------------------------------------------------------------------------- */

/* The verified bytes of a part that the record's surface has, malloc'ed: see store.h. */
enum server_store_outcome server_registry_fetch(struct server_registry *registry,
                                                const struct server_record *record,
                                                enum server_part part, void **bytes);

/* Can stored bytes be verified? A store that keeps none has none to look at. */
bool server_registry_can_verify(const struct server_registry *registry);

/* Compares a part that the record's surface has with its checksum: see store.h. */
enum server_store_verdict
server_registry_verify(struct server_registry *registry, const struct server_record *record,
                       enum server_part part, bool (*pace)(void *user, size_t bytes), void *user);

/* Keeps a surface in memory that was loaded, if its record is still the one of its key and no other
 * was quicker. */
void server_registry_keep(struct server_registry *registry, struct server_surface *surface);

/* Of the surfaces that are not in memory, the one that was used most; its record retained, or NULL.
 * Each is given once. */
struct server_record *server_registry_hottest(struct server_registry *registry);

/* Tells the store how often surfaces were used, if that changed since the last time. */
void server_registry_note_uses(struct server_registry *registry);

/* --- about it --------------------------------------------------------------------------------- */

struct server_registry_statistics {
    uint64_t surfaces, loaded, loads, unloads, damaged; /* damaged: files in quarantine */
};
struct server_registry_statistics server_registry_statistics(struct server_registry *registry);

/* Why nothing can be written, a sentence; NULL: all is well. */
const char *server_registry_health(struct server_registry *registry);

#endif
