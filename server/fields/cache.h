/* Field cache: distance fields in memory within the byte budget. Requests that need the same field
 * at the same time share one build.
 *
 *     hit = server_cache_find(fields, &source);             HTTP thread: a pinned field, or NULL
 *     if (!hit) server_cache_note(fields, &source);         counts the miss
 *     switch (server_cache_enter(fields, &source, job, &build)) {      a worker
 *     case SERVER_CACHE_SEARCH: not worth a field: answer without one
 *     case SERVER_CACHE_BUILD:  build; hit = server_cache_publish(build, field); ...
 *     case SERVER_CACHE_WAIT:   the job is parked: return; it will be resumed
 *     case SERVER_CACHE_AGAIN:  the field exists by now: call find again
 *     }
 *     server_cache_unpin(hit);
 *
 * DESIGN. A surface owns a *mesh cache*. Of fields with equal seeds it keeps the one of the largest
 * reach; a field of larger reach is resumed from it and replaces it. A *pending build* is a field
 * under construction: one builder and a list of parked jobs. When it ends, the parked jobs are
 * resumed and look again. A request of smaller reach does not wait: it builds its own field, which
 * may take much less time.
 *
 * Which fields are built: those that a client claims; and for pairs, the field of a point after
 * SERVER_CACHE_SEARCHES questions about that point (hot_points.h). A field costs as much as 10 to
 * 100 searches of single pairs, so the searches before it cost no more than the build, and a client
 * whose sources are all different does not fill the cache.
 *
 * Ownership: an entry has one reference of its mesh cache and one of each pin. Its bytes stay in
 * the budget until the last reference goes. The surface, the entries and the pending builds hold
 * references of the mesh cache. A field that is published to a closed mesh cache lives as long as
 * its pins.
 *
 * Eviction: by build time x uses / bytes, aged (eviction.h). Pinned entries stay.
 *
 * Locks: one mutex guards mesh caches, entries, their order and pending builds. Jobs are resumed or
 * refused and fields freed without it. The budget's reclaim locks it: so nothing is taken from the
 * budget under it. All functions are thread-safe. */
#ifndef SERVER_FIELDS_CACHE_H
#define SERVER_FIELDS_CACHE_H

#include "gd/field.h"
#include "server/fields/eviction.h"
#include "server/work/budget.h"
#include "server/work/workers.h"

struct server_cache;
struct server_mesh_cache;
struct server_pending_build;

/* A pinned field: valid until server_cache_unpin. */
struct server_cached {
    struct gd_field *field;
    struct server_evictable worth; /* the cache's own */
};

/* The cache becomes a reclaimer of `budget`; `workers` resume parked jobs. Both are borrowed. NULL
 * without memory. */
struct server_cache *server_cache_create(struct server_budget *budget,
                                         struct server_workers *workers);

/* All mesh caches are closed and all fields unpinned. NULL is harmless. */
void server_cache_destroy(struct server_cache *cache);

/* --- the fields of one mesh ------------------------------------------------------------------- */

/* An empty mesh cache with one reference, the caller's. NULL without memory. */
struct server_mesh_cache *server_mesh_cache_open(struct server_cache *cache);

/* Removes all fields and lets no more in; pins stay valid. May be called again. */
void server_mesh_cache_close(struct server_mesh_cache *fields);
void server_mesh_cache_release(struct server_mesh_cache *fields);

/* The whole fields of single points, each pinned, in an array for free(); NULL if there are
 * none. */
const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count);

uint32_t server_mesh_cache_count(struct server_mesh_cache *fields);

/* Adds a field of one source, unless the mesh cache has that field or memory is short. Takes over
 * the reference and gd_field_memsize bytes of SERVER_BUDGET_FLIGHT in any case. */
void server_cache_restore(struct server_mesh_cache *fields, struct gd_field *field);

/* --- finding ---------------------------------------------------------------------------------- */

/* A field of the seeds of this request, which has no target, that reaches as far or farther
 * (gd_field_within limits it); or the whole field of this point. Pinned and counted as used, or
 * NULL. Takes tens of nanoseconds, and more for many seeds. */
const struct server_cached *server_cache_find_field(struct server_mesh_cache *fields,
                                                    const struct gd_field_request *request);
const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source);
void server_cache_unpin(const struct server_cached *cached); /* NULL is harmless */

/* Removes the field of this request if it has exactly this reach; pins stay valid. */
void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request);

/* --- building --------------------------------------------------------------------------------- */

/* The mean search takes about a 16th of the time of the whole field: doc/003. */
#define SERVER_CACHE_SEARCHES 16

/* Counts a question about a point without a field. */
void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point);

enum server_cache_turn {
    SERVER_CACHE_SEARCH, /* no field: asked about too rarely, or memory is short */
    SERVER_CACHE_BUILD,  /* `*build` is the caller's to publish or to fail */
    SERVER_CACHE_WAIT,   /* `job` is parked until the build ends or its deadline passes */
    SERVER_CACHE_AGAIN   /* the field exists by now */
};

/* Asks for the field of a point that was not found. */
enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build);

/* The same for a field that the request can't do without; the request has no target. SEARCH: `*why`
 * is GD_NO_MEMORY, or the error of a build of this field less than a second ago. */
enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why);

/* The field that this build can be resumed from, pinned; NULL: there is none. */
const struct server_cached *server_cache_find_nearer(struct server_pending_build *build);

/* True when jobs are parked on the build: then its builder goes on even if its own client has gone
 * away. */
bool server_cache_is_awaited(struct server_pending_build *build);

/* Ends a build with its field, resumes the parked jobs and frees the build. Takes over the field's
 * reference and gd_field_memsize bytes of SERVER_BUDGET_FLIGHT. Returns the field pinned; NULL
 * without memory: then the field is released. */
const struct server_cached *server_cache_publish(struct server_pending_build *build,
                                                 struct gd_field *field);

/* Ends a build without a field, resumes the parked jobs and frees the build. After GD_DEADLINE and
 * GD_CANCELLED one of the parked jobs may become the builder. Any other error is the same for all:
 * for one second server_cache_claim returns it without a new build. */
void server_cache_fail(struct server_pending_build *build, enum gd_status status);

/* Refuses the parked jobs whose deadline has passed. */
void server_cache_expire(struct server_cache *cache, uint64_t now_ns);

struct server_cache_statistics {
    uint64_t hits, misses, builds, resumed, waits, evictions, fields;
};
struct server_cache_statistics server_cache_statistics(struct server_cache *cache);

#endif
