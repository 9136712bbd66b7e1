/* See cache.h. */
#include "server/fields/cache.h"

#include <assert.h>
#include <stdlib.h>

#include "server/fields/cache_parts.h"

#define FAILURE_NS UINT64_C(1000000000) /* for so long a build that failed is not tried again */

/* --- eviction, under the lock ----------------------------------------------------------------- */

/* Takes unpinned entries off their mesh caches, in the order of eviction, until they hold `bytes`
 * or none is left. Returns them as a list. */
static struct server_entry *evict(struct server_cache *cache, size_t bytes)
{
    struct server_entry *evicted = NULL, *pinned = NULL, *first;
    for (size_t freed = 0;
         freed < bytes && (first = server_entry_of(server_eviction_first(&cache->eviction)));) {
        bool is_pinned = atomic_load(&first->references) > 1;
        struct server_entry **list = is_pinned ? &pinned : &evicted;
        if (is_pinned) {
            server_eviction_remove(&cache->eviction, &first->worth);
        } else {
            server_eviction_evict(&cache->eviction, &first->worth);
            server_mesh_cache_remove(first);
            freed += first->worth.bytes;
            cache->statistics.evictions++;
        }
        first->next = *list;
        *list = first;
    }
    for (; pinned; pinned = pinned->next) server_eviction_insert(&cache->eviction, &pinned->worth);
    return evicted;
}

static void reclaim(void *user, size_t bytes)
{
    struct server_cache *cache = user;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *evicted = evict(cache, bytes);
    pthread_mutex_unlock(&cache->lock);
    server_entries_release(evicted);
}

/* --- the cache -------------------------------------------------------------------------------- */

struct server_cache *server_cache_create(struct server_budget *budget,
                                         struct server_workers *workers)
{
    struct server_cache *cache = calloc(1, sizeof *cache);
    if (!cache) return NULL;
    pthread_mutex_init(&cache->lock, NULL);
    cache->budget = budget;
    cache->workers = workers;
    budget->reclaimers[SERVER_RECLAIM_FIELDS] = (struct server_reclaimer){reclaim, NULL, cache};
    return cache;
}

void server_cache_destroy(struct server_cache *cache)
{
    if (!cache) return;
    assert(!cache->eviction.order.size && !cache->builds.first);
    cache->budget->reclaimers[SERVER_RECLAIM_FIELDS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&cache->lock);
    server_eviction_free(&cache->eviction);
    free(cache);
}

struct server_cache_statistics server_cache_statistics(struct server_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    struct server_cache_statistics statistics = cache->statistics;
    pthread_mutex_unlock(&cache->lock);
    return statistics;
}

/* --- find and drop ---------------------------------------------------------------------------- */

static const struct server_cached *find(struct server_mesh_cache *fields,
                                        const struct server_field_key *key)
{
    struct server_cache *cache = fields->cache;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_mesh_cache_find_covering(fields, key);
    if (entry) {
        atomic_fetch_add(&entry->references, 1);
        server_eviction_use(&cache->eviction, &entry->worth);
        cache->statistics.hits++;
    } else {
        cache->statistics.misses++;
    }
    pthread_mutex_unlock(&cache->lock);
    return entry ? &entry->cached : NULL;
}

const struct server_cached *server_cache_find_field(struct server_mesh_cache *fields,
                                                    const struct gd_field_request *request)
{
    struct server_field_key key = server_field_key_of(request);
    return find(fields, &key);
}

const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(source, &seed);
    return find(fields, &key);
}

void server_cache_unpin(const struct server_cached *cached)
{
    if (cached) server_entry_release((struct server_entry *)cached);
}

void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request)
{
    struct server_cache *cache = fields->cache;
    struct server_field_key key = server_field_key_of(request);
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_mesh_cache_find(fields, &key);
    if (entry && entry->slot.key.radius != key.radius) entry = NULL;
    if (entry) server_mesh_cache_withdraw(entry);
    pthread_mutex_unlock(&cache->lock);
    if (entry) server_entry_release(entry);
}

/* --- who builds ------------------------------------------------------------------------------- */

void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(point, &seed);
    pthread_mutex_lock(&fields->cache->lock);
    server_hot_points_note(&fields->hot_points, key.hash);
    pthread_mutex_unlock(&fields->cache->lock);
}

/* AGAIN or WAIT if the field is there or on its way, or one is that it can be resumed from; else
 * SEARCH. */
static enum server_cache_turn board(struct server_mesh_cache *fields,
                                    const struct server_field_key *key, struct server_job *job)
{
    struct server_cache *cache = fields->cache;
    if (server_mesh_cache_find_covering(fields, key)) return SERVER_CACHE_AGAIN;
    struct server_pending_build *build = server_pending_builds_find(&cache->builds, fields, key);
    if (!build) return SERVER_CACHE_SEARCH;
    server_pending_build_park(build, job);
    cache->statistics.waits++;
    return SERVER_CACHE_WAIT;
}

/* BUILD, or SEARCH without memory. */
static enum server_cache_turn start(struct server_mesh_cache *fields,
                                    const struct server_field_key *key,
                                    struct server_pending_build **out)
{
    struct server_cache *cache = fields->cache;
    struct server_pending_build *build = server_pending_builds_start(&cache->builds, fields, key);
    if (!build) return SERVER_CACHE_SEARCH;
    atomic_fetch_add(&fields->references, 1);
    cache->statistics.builds++;
    *out = build;
    return SERVER_CACHE_BUILD;
}

enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(source, &seed);
    pthread_mutex_lock(&fields->cache->lock);
    enum server_cache_turn turn = board(fields, &key, job);
    if (turn == SERVER_CACHE_SEARCH &&
        server_hot_points_count(&fields->hot_points, key.hash) >= SERVER_CACHE_SEARCHES)
        turn = start(fields, &key, build);
    pthread_mutex_unlock(&fields->cache->lock);
    return turn;
}

enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why)
{
    struct server_field_key key = server_field_key_of(request);
    pthread_mutex_lock(&fields->cache->lock);
    const struct server_failure *failure = &fields->failure;
    const struct server_field_key failed = {.hash = failure->hash, .radius = failure->radius};
    bool has_failed = failed.hash == key.hash && server_field_key_covers(&key, &failed) &&
                      gd_now_ns() < failure->until_ns;
    enum server_cache_turn turn = board(fields, &key, job);
    if (turn == SERVER_CACHE_SEARCH && !has_failed) turn = start(fields, &key, build);
    if (turn == SERVER_CACHE_SEARCH) *why = has_failed ? failure->status : GD_NO_MEMORY;
    pthread_mutex_unlock(&fields->cache->lock);
    return turn;
}

const struct server_cached *server_cache_find_nearer(struct server_pending_build *build)
{
    struct server_cache *cache = build->fields->cache;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_mesh_cache_find(build->fields, &build->key);
    if (entry && server_field_key_covers(&entry->slot.key, &build->key)) entry = NULL;
    if (entry) {
        atomic_fetch_add(&entry->references, 1);
        cache->statistics.resumed++;
    }
    pthread_mutex_unlock(&cache->lock);
    return entry ? &entry->cached : NULL;
}

bool server_cache_is_awaited(struct server_pending_build *build)
{
    pthread_mutex_lock(&build->fields->cache->lock);
    bool awaited = build->parked != NULL;
    pthread_mutex_unlock(&build->fields->cache->lock);
    return awaited;
}

/* --- landing ---------------------------------------------------------------------------------- */

/* Frees a pending build that has ended and has those who waited look again. */
static void disperse(struct server_pending_build *build)
{
    struct server_mesh_cache *fields = build->fields;
    for (struct server_job *job = server_pending_build_free(build), *next; job; job = next) {
        next = job->next;
        server_workers_resume(fields->cache->workers, job);
    }
    server_mesh_cache_release(fields);
}

/* Only the whole field of a point answers what was counted. */
static void forget(struct server_pending_build *build)
{
    if (build->key.radius == 0)
        server_hot_points_forget(&build->fields->hot_points, build->key.hash);
}

const struct server_cached *server_cache_publish(struct server_pending_build *build,
                                                 struct gd_field *field)
{
    struct server_cache *cache = build->fields->cache;
    struct server_entry *entry = server_entry_create(build->fields, &build->key, field);
    pthread_mutex_lock(&cache->lock);
    server_pending_builds_end(&cache->builds, build);
    forget(build);
    /* without memory it lives as long as its pins */
    struct server_entry *replaced = server_mesh_cache_put(entry);
    pthread_mutex_unlock(&cache->lock);
    if (replaced) server_entry_release(replaced);
    disperse(build);
    return entry ? &entry->cached : NULL;
}

void server_cache_restore(struct server_mesh_cache *fields, struct gd_field *field)
{
    struct server_cache *cache = fields->cache;
    struct gd_point source;
    struct gd_seed seed;
    if (!gd_field_single_seed(field, &source)) {
        server_budget_give(cache->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field));
        gd_field_release(field);
        return;
    }
    struct server_field_key key = server_field_key_of_point(&source, &seed);
    struct server_entry *entry = server_entry_create(fields, &key, field);
    if (!entry) return;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *replaced = server_mesh_cache_put(entry);
    pthread_mutex_unlock(&cache->lock);
    if (replaced) server_entry_release(replaced);
    server_entry_release(entry);
}

void server_cache_fail(struct server_pending_build *build, enum gd_status status)
{
    struct server_mesh_cache *fields = build->fields;
    struct server_cache *cache = fields->cache;
    bool is_worth_another = status == GD_CANCELLED || status == GD_DEADLINE;
    pthread_mutex_lock(&cache->lock);
    server_pending_builds_end(&cache->builds, build);
    if (!is_worth_another) {
        forget(build);
        fields->failure = (struct server_failure){build->key.hash, gd_now_ns() + FAILURE_NS,
                                                  build->key.radius, status};
    }
    pthread_mutex_unlock(&cache->lock);
    disperse(build);
}

void server_cache_expire(struct server_cache *cache, uint64_t now_ns)
{
    pthread_mutex_lock(&cache->lock);
    struct server_job *expired = server_pending_builds_expire(&cache->builds, now_ns);
    pthread_mutex_unlock(&cache->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
