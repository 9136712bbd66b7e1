/* Field cache: distance fields in memory within the byte budget. Requests that need the same field
 * at the same time share one build.
 *
 *     hit = server_cache_find(fields, &source);             HTTP thread: a pinned field, or NULL
 *     if (!hit) server_cache_note(fields, &source);         count the miss
 *     switch (server_cache_enter(fields, &source, job, &build)) {      a worker
 *     case SERVER_CACHE_SEARCH: queried too rarely for a field: answer without one
 *     case SERVER_CACHE_BUILD:  build; hit = server_cache_publish(build, field); ...
 *     case SERVER_CACHE_WAIT:   return; the parked job will be resumed
 *     case SERVER_CACHE_AGAIN:  the field exists now: call find again
 *     }
 *     server_cache_unpin(hit);
 *
 * DESIGN. A surface owns a *mesh cache*, which holds its fields. The *seeds* of a field are its
 * sources. Its *reach* is the distance up to which it is computed. If several fields have equal
 * seeds, the mesh cache keeps only the field of the largest reach. A *pending build* has one
 * builder. Other jobs are parked at the build (workers.h) until it ends, and then look up the field
 * again. A request of another reach does not wait: a field of smaller reach may take much less
 * time, and one of larger reach needs another build.
 *
 * A field is built when a request claims it. For queries of pairs, the field of a point is built
 * after SERVER_CACHE_SEARCHES queries of that point (hot_points.h), because a field costs as much
 * as 10 to 100 searches for pairs. So a client that never repeats a source does not fill the cache.
 *
 * Fields without pins can be evicted, by GreedyDual-Size-Frequency (Cherkasova, "Improving WWW
 * proxies performance with GreedyDual-Size-Frequency caching policy", 1998). At each use a field's
 * priority becomes the priority of the last evicted field, plus build time x uses / bytes. The
 * field of the lowest priority in a sample is evicted. The budget counts a field until its last pin
 * is released. A field that is published to a closed mesh cache lives as long as its pins.
 *
 * One mutex guards the whole cache; the workers' lock is acquired after this mutex. No field is
 * freed under the mutex. The budget's reclaimer locks the mutex, so a thread that holds it must not
 * take memory from the budget. All functions are thread-safe. */
#pragma once

#include "gd/field.h"
#include "server/work/budget.h"
#include "server/work/workers.h"

struct server_cache;
struct server_mesh_cache;
struct server_pending_build;

/* A pinned field: valid until server_cache_unpin. */
struct server_cached {
    struct gd_field *field;
    double cost; /* private: time of a rebuild in nanoseconds */
};

/* Creates a cache, which registers as a reclaimer of `budget` and parks jobs with `workers`.
 * Borrows both. Returns NULL if out of memory. */
struct server_cache *server_cache_create(struct server_budget *budget,
                                         struct server_workers *workers);

/* Call this function when all mesh caches are closed and all fields are unpinned. NULL is
 * allowed. */
void server_cache_destroy(struct server_cache *cache);

/* Creates an empty mesh cache with one reference, the caller's. Returns NULL if out of memory. */
struct server_mesh_cache *server_mesh_cache_open(struct server_cache *cache);

/* Removes all fields and rejects later fields. Pins stay valid. May be called again. */
void server_mesh_cache_close(struct server_mesh_cache *fields);
void server_mesh_cache_release(struct server_mesh_cache *fields);

/* Pins the complete fields of single points. Returns them in an array, which the caller frees by
 * free(); NULL if there are none. */
const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count);

uint32_t server_mesh_cache_count(struct server_mesh_cache *fields);

/* Adds a field of one source, unless the mesh cache has that field or memory is short. Takes over
 * the reference and gd_field_memsize bytes of SERVER_BUDGET_FLIGHT in any case. */
void server_cache_restore(struct server_mesh_cache *fields, struct gd_field *field);

/* server_cache_find_field returns a field with the seeds of the request and at least its reach;
 * gd_field_within limits a larger reach. The request must have no target. server_cache_find returns
 * the complete field of a point. Both pin the field and count a use. NULL means that there is no
 * such field. O(seeds); tens of nanoseconds for one seed. */
const struct server_cached *server_cache_find_field(struct server_mesh_cache *fields,
                                                    const struct gd_field_request *request);
const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source);
void server_cache_unpin(const struct server_cached *cached); /* NULL is allowed */

/* Removes the field of this request if the field has exactly this reach. Pins stay valid. */
void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request);

/* Number of queries of a point before its field is built. An average search takes about 1/16 of the
 * time of a complete field (server/doc/003). After a failed or abandoned build on a surface, the
 * number is doubled for this surface until a build succeeds. */
#define SERVER_CACHE_SEARCHES 16

/* Counts a query of a point without a field. */
void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point);

enum server_cache_turn {
    SERVER_CACHE_SEARCH, /* no field: the point is queried too rarely, or memory is short */
    SERVER_CACHE_BUILD,  /* the caller must end `*build` by one of the three functions below */
    SERVER_CACHE_WAIT,   /* `job` is parked until the build ends or its deadline passes */
    SERVER_CACHE_AGAIN   /* the field exists by now */
};

enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build);

/* Like server_cache_enter, but the request needs the field and has no target. With SEARCH it sets
 * `*why`: GD_NO_MEMORY, GD_CANCELLED, or the error of a build of this field that failed less than a
 * second ago. If `job` is NULL, returns SEARCH instead of WAIT. */
enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why);

/* Returns true if jobs are parked at the build. The build must then continue even if its client has
 * disconnected. */
bool server_cache_is_awaited(struct server_pending_build *build);

/* Both functions end and free a build, and resume the parked jobs. server_cache_publish takes over
 * the field's reference and gd_field_memsize bytes of SERVER_BUDGET_FLIGHT, and returns the field
 * pinned. If out of memory, it releases the field and returns NULL. After server_cache_fail with
 * GD_DEADLINE or GD_CANCELLED a parked job may become the builder. server_cache_claim returns any
 * other error for one second. */
const struct server_cached *server_cache_publish(struct server_pending_build *build,
                                                 struct gd_field *field);
void server_cache_fail(struct server_pending_build *build, enum gd_status status);

/* Ends and frees a build that takes much longer than the searches that it would replace. Resumes
 * the parked jobs, which then search instead. */
void server_cache_abandon(struct server_pending_build *build);

struct server_cache_statistics {
    uint64_t hits, misses, builds, waits, evictions, fields;
};
struct server_cache_statistics server_cache_statistics(struct server_cache *cache);
