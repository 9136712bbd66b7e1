/* See cache.h. */
#include "server/fields/cache.h"

#include <assert.h>
#include <stdlib.h>

#include "server/fields/cache_parts.h"

#define FAILURE_NS UINT64_C(1000000000) /* for so long a build that failed is not tried again */

/* --- eviction, under the lock ----------------------------------------------------------------- */

/* Takes unpinned entries off their shelves, in the order of eviction, until they hold `bytes` or
 * none is left. Returns them as a list. */
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
            server_shelf_remove(first);
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
    assert(!cache->eviction.order.size && !cache->flights.first);
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

static const struct server_cached *find(struct server_shelf *shelf,
                                        const struct server_field_key *key)
{
    struct server_cache *cache = shelf->cache;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_shelf_find_covering(shelf, key);
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

const struct server_cached *server_cache_find_field(struct server_shelf *shelf,
                                                    const struct gd_field_request *request)
{
    struct server_field_key key = server_field_key_of(request);
    return find(shelf, &key);
}

const struct server_cached *server_cache_find(struct server_shelf *shelf,
                                              const struct gd_point *source)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(source, &seed);
    return find(shelf, &key);
}

void server_cache_unpin(const struct server_cached *cached)
{
    if (cached) server_entry_release((struct server_entry *)cached);
}

void server_cache_drop(struct server_shelf *shelf, const struct gd_field_request *request)
{
    struct server_cache *cache = shelf->cache;
    struct server_field_key key = server_field_key_of(request);
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_shelf_find(shelf, &key);
    if (entry && entry->slot.key.radius != key.radius) entry = NULL;
    if (entry) server_shelf_withdraw(entry);
    pthread_mutex_unlock(&cache->lock);
    if (entry) server_entry_release(entry);
}

/* --- who builds ------------------------------------------------------------------------------- */

void server_cache_note(struct server_shelf *shelf, const struct gd_point *point)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(point, &seed);
    pthread_mutex_lock(&shelf->cache->lock);
    server_recent_note(&shelf->recent, key.hash);
    pthread_mutex_unlock(&shelf->cache->lock);
}

/* AGAIN or WAIT if the field is there or on its way, or one is that it can be resumed from; else
 * SEARCH. */
static enum server_cache_turn board(struct server_shelf *shelf, const struct server_field_key *key,
                                    struct server_job *job)
{
    struct server_cache *cache = shelf->cache;
    if (server_shelf_find_covering(shelf, key)) return SERVER_CACHE_AGAIN;
    struct server_flight *flight = server_flights_find(&cache->flights, shelf, key);
    if (!flight) return SERVER_CACHE_SEARCH;
    server_flight_park(flight, job);
    cache->statistics.waits++;
    return SERVER_CACHE_WAIT;
}

/* BUILD, or SEARCH without memory. */
static enum server_cache_turn start(struct server_shelf *shelf, const struct server_field_key *key,
                                    struct server_flight **out)
{
    struct server_cache *cache = shelf->cache;
    struct server_flight *flight = server_flights_start(&cache->flights, shelf, key);
    if (!flight) return SERVER_CACHE_SEARCH;
    atomic_fetch_add(&shelf->references, 1);
    cache->statistics.builds++;
    *out = flight;
    return SERVER_CACHE_BUILD;
}

enum server_cache_turn server_cache_enter(struct server_shelf *shelf, const struct gd_point *source,
                                          struct server_job *job, struct server_flight **flight)
{
    struct gd_seed seed;
    struct server_field_key key = server_field_key_of_point(source, &seed);
    pthread_mutex_lock(&shelf->cache->lock);
    enum server_cache_turn turn = board(shelf, &key, job);
    if (turn == SERVER_CACHE_SEARCH &&
        server_recent_count(&shelf->recent, key.hash) >= SERVER_CACHE_SEARCHES)
        turn = start(shelf, &key, flight);
    pthread_mutex_unlock(&shelf->cache->lock);
    return turn;
}

enum server_cache_turn server_cache_claim(struct server_shelf *shelf,
                                          const struct gd_field_request *request,
                                          struct server_job *job, struct server_flight **flight,
                                          enum gd_status *why)
{
    struct server_field_key key = server_field_key_of(request);
    pthread_mutex_lock(&shelf->cache->lock);
    const struct server_failure *failure = &shelf->failure;
    const struct server_field_key failed = {.hash = failure->hash, .radius = failure->radius};
    bool has_failed = failed.hash == key.hash && server_field_key_covers(&key, &failed) &&
                      gd_now_ns() < failure->until_ns;
    enum server_cache_turn turn = board(shelf, &key, job);
    if (turn == SERVER_CACHE_SEARCH && !has_failed) turn = start(shelf, &key, flight);
    if (turn == SERVER_CACHE_SEARCH) *why = has_failed ? failure->status : GD_NO_MEMORY;
    pthread_mutex_unlock(&shelf->cache->lock);
    return turn;
}

const struct server_cached *server_cache_find_nearer(struct server_flight *flight)
{
    struct server_cache *cache = flight->shelf->cache;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *entry = server_shelf_find(flight->shelf, &flight->key);
    if (entry && server_field_key_covers(&entry->slot.key, &flight->key)) entry = NULL;
    if (entry) {
        atomic_fetch_add(&entry->references, 1);
        cache->statistics.resumed++;
    }
    pthread_mutex_unlock(&cache->lock);
    return entry ? &entry->cached : NULL;
}

bool server_cache_is_awaited(struct server_flight *flight)
{
    pthread_mutex_lock(&flight->shelf->cache->lock);
    bool awaited = flight->parked != NULL;
    pthread_mutex_unlock(&flight->shelf->cache->lock);
    return awaited;
}

/* --- landing ---------------------------------------------------------------------------------- */

/* Frees a flight that has ended and has those who waited look again. */
static void disperse(struct server_flight *flight)
{
    struct server_shelf *shelf = flight->shelf;
    for (struct server_job *job = server_flight_free(flight), *next; job; job = next) {
        next = job->next;
        server_workers_resume(shelf->cache->workers, job);
    }
    server_shelf_release(shelf);
}

/* Only the whole field of a point answers what was counted. */
static void forget(struct server_flight *flight)
{
    if (flight->key.radius == 0) server_recent_forget(&flight->shelf->recent, flight->key.hash);
}

const struct server_cached *server_cache_land(struct server_flight *flight, struct gd_field *field)
{
    struct server_cache *cache = flight->shelf->cache;
    struct server_entry *entry = server_entry_create(flight->shelf, &flight->key, field);
    pthread_mutex_lock(&cache->lock);
    server_flights_end(&cache->flights, flight);
    forget(flight);
    /* without memory it lives as long as its pins */
    struct server_entry *replaced = server_shelf_put(entry);
    pthread_mutex_unlock(&cache->lock);
    if (replaced) server_entry_release(replaced);
    disperse(flight);
    return entry ? &entry->cached : NULL;
}

void server_cache_restore(struct server_shelf *shelf, struct gd_field *field)
{
    struct server_cache *cache = shelf->cache;
    struct gd_point source;
    struct gd_seed seed;
    if (!gd_field_single_seed(field, &source)) {
        server_budget_give(cache->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field));
        gd_field_release(field);
        return;
    }
    struct server_field_key key = server_field_key_of_point(&source, &seed);
    struct server_entry *entry = server_entry_create(shelf, &key, field);
    if (!entry) return;
    pthread_mutex_lock(&cache->lock);
    struct server_entry *replaced = server_shelf_put(entry);
    pthread_mutex_unlock(&cache->lock);
    if (replaced) server_entry_release(replaced);
    server_entry_release(entry);
}

void server_cache_fail(struct server_flight *flight, enum gd_status status)
{
    struct server_shelf *shelf = flight->shelf;
    struct server_cache *cache = shelf->cache;
    bool is_worth_another = status == GD_CANCELLED || status == GD_DEADLINE;
    pthread_mutex_lock(&cache->lock);
    server_flights_end(&cache->flights, flight);
    if (!is_worth_another) {
        forget(flight);
        shelf->failure = (struct server_failure){flight->key.hash, gd_now_ns() + FAILURE_NS,
                                                 flight->key.radius, status};
    }
    pthread_mutex_unlock(&cache->lock);
    disperse(flight);
}

void server_cache_expire(struct server_cache *cache, uint64_t now_ns)
{
    pthread_mutex_lock(&cache->lock);
    struct server_job *expired = server_flights_expire(&cache->flights, now_ns);
    pthread_mutex_unlock(&cache->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
