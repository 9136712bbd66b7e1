/* Cache: fields in memory under the byte budget, each built once however many ask for it at the
 * same time.
 *
 *     const struct server_cached *hit = server_cache_find(fields, &source);      first lane: a
 * pinned field, or NULL
 *     ...
 *     server_cache_note(fields, &source);                                        none: counted
 *     switch (server_cache_enter(fields, &source, job, &build)) {               second
 * lane case SERVER_CACHE_SEARCH: not worth a field: do without case SERVER_CACHE_BUILD:  build; hit
 * = server_cache_publish(build, field); ... case SERVER_CACHE_WAIT:   the job is parked:
 * return, it will be resumed case SERVER_CACHE_AGAIN:  a field is there by now: look again
 *     }
 *     server_cache_unpin(hit);
 *
 * DESIGN. The fields of one mesh stand on a *mesh cache*, which the mesh's surface owns, each under
 * the seeds of its request (field_key.h): of the same seeds the one that reaches farthest, which
 * answers all requests that reach no farther. One that is to reach farther is resumed from it and
 * takes its place. The whole field of one point, without an offset, is the one that pairs of points
 * are answered from too. A field that is being built is a *pending build*: it has one builder and a
 * list of parked jobs that wait for it (pending_builds.h). When it lands, the field stands on the
 * mesh cache and the parked jobs are resumed to look again: those that want it, and those that want
 * a farther one, which is resumed from it. Who wants a nearer one builds it meanwhile, as that may
 * be done much sooner.
 *
 * What is built: what a client claims; and for pairs, since a field costs as much as 10 to 100
 * searches for single pairs, and much memory, the field of a point once SERVER_CACHE_SEARCHES
 * questions about it found none (hot_points.h): so the searches before it cost no more than the
 * build itself, and who asks from everywhere fills the cache with nothing.
 *
 * Ownership: an entry is counted, one for the mesh cache and one for each pin. Its bytes stay in
 * the budget until the last pin goes. A mesh cache is counted too: its surface, its entries, its
 * pending builds. A closed mesh cache keeps nothing: what lands on it lives as long as its pins.
 *
 * Eviction: by build time x uses / bytes, aged (eviction.h). Pinned entries stay.
 *
 * Locks: one mutex guards mesh caches, entries, their order and pending builds. Under it nothing
 * calls out: budget gives are atomic, jobs are resumed or refused and fields freed after it is
 * released. The budget's reclaim takes it: so nothing is taken from the budget under it. */
#ifndef SERVER_FIELDS_CACHE_H
#define SERVER_FIELDS_CACHE_H

#include "gd/field.h"
#include "server/work/budget.h"
#include "server/work/workers.h"

struct server_cache;
struct server_mesh_cache;
struct server_pending_build;

/* A pinned field: valid until server_cache_unpin. */
struct server_cached {
    struct gd_field *field;
};

/* `budget` becomes the cache's to reclaim from; `workers` resume parked jobs. Both are borrowed and
 * outlive the cache. NULL: no memory. */
struct server_cache *server_cache_create(struct server_budget *budget,
                                         struct server_workers *workers);

/* All mesh caches are closed and all pins gone by then. NULL is harmless. */
void server_cache_destroy(struct server_cache *cache);

/* An empty mesh cache with one reference, the caller's, or NULL without memory. */
struct server_mesh_cache *server_mesh_cache_open(struct server_cache *cache);

/* Ends the mesh cache's fields: pins stay valid, nothing finds any more, pending builds land
 * without being kept. A second time is harmless. */
void server_mesh_cache_close(struct server_mesh_cache *fields);
void server_mesh_cache_release(struct server_mesh_cache *fields);

/* The mesh cache's whole fields of single points, each pinned, as an array to be freed by free();
 * NULL when the mesh cache is empty. */
const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count);

/* Puts a field of one source on the mesh cache, whose reference and gd_field_memsize bytes of
 * SERVER_BUDGET_FLIGHT pass to the cache, unless the mesh cache has one of that source, or there is
 * no memory: then both are gone. */
void server_cache_restore(struct server_mesh_cache *fields, struct gd_field *field);

/* Fields on the mesh cache. */
uint32_t server_mesh_cache_count(struct server_mesh_cache *fields);

/* A field of this request's seeds, which has no target, that reaches as far or farther
 * (gd_field_within is for who is to know no more), or the whole field of this point; pinned and
 * counted as used, or NULL. Tens of nanoseconds, and some for each seed. */
const struct server_cached *server_cache_find_field(struct server_mesh_cache *fields,
                                                    const struct gd_field_request *request);
const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source);
void server_cache_unpin(const struct server_cached *cached); /* NULL is harmless */

/* Takes the field of this request off the mesh cache, if it is there and reaches no farther; pins
 * stay valid. */
void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request);

/* the mean search takes about a 16th of the whole field, see doc/003 */
#define SERVER_CACHE_SEARCHES 16

/* Counts a question about a point whose field is not there. */
void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point);

enum server_cache_turn {
    SERVER_CACHE_SEARCH,
    SERVER_CACHE_BUILD,
    SERVER_CACHE_WAIT,
    SERVER_CACHE_AGAIN
};

/* Asks for a field that was not there. SEARCH: the source was not asked about often enough, or
 * there is no memory. BUILD:
 * `*build` is the caller's to land or to abandon. WAIT: `job` is parked until the pending
 * build has ended or its deadline passes. AGAIN: the mesh cache has the field by now. */
enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build);

/* The same for a field that has to be there, whose request has no target. SEARCH: it can't be, and
 * `*why` is what its builder met with a moment ago, or GD_NO_MEMORY. */
enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why);

/* The field that the pending build's can be resumed from, pinned; NULL: there is none. */
const struct server_cached *server_cache_find_nearer(struct server_pending_build *build);

/* True when other jobs wait for the pending build: its builder goes on even if its own client went
 * away.
 */
bool server_cache_is_awaited(struct server_pending_build *build);

/* Ends a pending build with its field, whose reference and gd_field_memsize bytes of
 * SERVER_BUDGET_FLIGHT pass to the cache; returns it pinned. On NO_MEMORY (NULL is returned) field
 * and bytes are gone. The pending build is freed, the parked jobs are resumed. */
const struct server_cached *server_cache_publish(struct server_pending_build *build,
                                                 struct gd_field *field);

/* Ends a pending build without a field; the parked jobs are resumed. After GD_DEADLINE and
 * GD_CANCELLED, which are its builder's own, one of the others may become the next builder. Else
 * the build would fail for anybody: the source is forgotten, so that those who can do without, and
 * who claims it in the next second is told the same. */
void server_cache_fail(struct server_pending_build *build, enum gd_status status);

/* Refuses the parked jobs whose deadline has passed. */
void server_cache_expire(struct server_cache *cache, uint64_t now_ns);

struct server_cache_statistics {
    uint64_t hits, misses, builds, resumed, waits, evictions, fields;
};
struct server_cache_statistics server_cache_statistics(struct server_cache *cache);

#endif
