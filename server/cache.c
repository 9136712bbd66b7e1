/* See cache.h. */
#include "server/cache.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/heap.h"
#include "server/recent.h"

#define SHELF_FIRST_BUCKETS 8

struct entry {
    struct server_cached cached; /* first: a pin is a pointer to it */
    atomic_uint references;      /* the shelf's and the pins' */
    struct server_shelf *shelf;
    struct entry *next;  /* in its bucket; or, off its shelf, in a list of entries to release */
    struct entry *aside; /* in the list of pinned entries that an eviction passes over */
    struct gd_point source;
    size_t bytes;
    uint64_t uses;
    double priority; /* now */
    struct server_heap_node
        node; /* in the order of eviction; its key is an earlier priority, since priorities only grow */
};

struct server_shelf {
    atomic_uint references;
    struct server_cache *cache;
    bool closed;
    struct entry **buckets;
    uint32_t bucket_count, entry_count; /* bucket_count is a power of two, or 0 */
    struct server_recent recent;        /* points that had no field when they were asked about */
};

struct server_flight {
    struct server_shelf *shelf;
    struct server_flight *next; /* in the cache's list: as many as jobs can be queued or run at most */
    struct gd_point source;
    struct server_job *parked;
};

struct server_cache {
    struct server_budget *budget;
    struct server_workers *workers;
    pthread_mutex_t lock;
    struct server_heap order; /* of all entries on shelves, for eviction */
    double age;
    struct server_flight *flights;
    struct server_cache_statistics statistics;
};

/* --- counting ----------------------------------------------------------------------------------------------------- */

void server_shelf_release(struct server_shelf *shelf)
{
    if (atomic_fetch_sub(&shelf->references, 1) != 1) return;
    free(shelf->buckets);
    free(shelf);
}

/* May free a field: not under the lock. */
static void entry_release(struct entry *entry)
{
    if (atomic_fetch_sub(&entry->references, 1) != 1) return;
    server_budget_give(entry->shelf->cache->budget, SERVER_BUDGET_FIELDS, entry->bytes);
    gd_field_release(entry->cached.field);
    server_shelf_release(entry->shelf);
    free(entry);
}

/* Releases a list of entries that were taken off their shelves, linked by `next`. */
static void release_all(struct entry *entry)
{
    while (entry) {
        struct entry *next = entry->next;
        entry_release(entry);
        entry = next;
    }
}

/* --- the order of eviction, under the lock ------------------------------------------------------------------------ */

static struct entry *entry_of(struct server_heap_node *node)
{
    return (struct entry *)((char *)node - offsetof(struct entry, node));
}

/* Puts an entry in at its priority, room having been reserved. */
static void order_insert(struct server_cache *cache, struct entry *entry)
{
    entry->node.key = entry->priority;
    server_heap_insert(&cache->order, &entry->node);
}

/* The entry of the lowest priority, with the keys on the way to it brought up to date; NULL when there is none. */
static struct entry *order_lowest(struct server_cache *cache)
{
    while (cache->order.size) {
        struct entry *lowest = entry_of(cache->order.nodes[0]);
        if (lowest->node.key >= lowest->priority) return lowest;
        server_heap_raise(&cache->order, &lowest->node, lowest->priority);
    }
    return NULL;
}

/* --- a shelf's entries, under the lock ---------------------------------------------------------------------------- */

static uint64_t hash_mix(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ hash >> 29;
}

static uint64_t point_hash(const struct gd_point *point)
{
    uint64_t hash = hash_mix((uint64_t)point->kind, point->element);
    int weights = point->kind == GD_POINT_FACE ? 3 : point->kind == GD_POINT_EDGE ? 1 : 0;
    for (int i = 0; i < weights; i++) {
        uint64_t bits;
        memcpy(&bits, &point->weight[i], sizeof bits);
        hash = hash_mix(hash, bits);
    }
    return hash;
}

static struct entry **shelf_bucket(const struct server_shelf *shelf, const struct gd_point *source)
{
    return &shelf->buckets[point_hash(source) & (shelf->bucket_count - 1)];
}

static struct entry *shelf_find(const struct server_shelf *shelf, const struct gd_point *source)
{
    if (!shelf->bucket_count) return NULL;
    struct entry *entry = *shelf_bucket(shelf, source);
    while (entry && !gd_point_equal(&entry->source, source)) entry = entry->next;
    return entry;
}

static bool shelf_reserve(struct server_shelf *shelf)
{
    if (shelf->entry_count < shelf->bucket_count) return true;
    struct server_shelf grown = {.bucket_count = shelf->bucket_count ? 2 * shelf->bucket_count : SHELF_FIRST_BUCKETS};
    grown.buckets = calloc(grown.bucket_count, sizeof *grown.buckets);
    if (!grown.buckets) return false;
    for (uint32_t i = 0; i < shelf->bucket_count; i++) {
        for (struct entry *entry = shelf->buckets[i], *next; entry; entry = next) {
            next = entry->next;
            struct entry **bucket = shelf_bucket(&grown, &entry->source);
            entry->next = *bucket;
            *bucket = entry;
        }
    }
    free(shelf->buckets);
    shelf->buckets = grown.buckets;
    shelf->bucket_count = grown.bucket_count;
    return true;
}

static void set_priority(const struct server_cache *cache, struct entry *entry)
{
    double build_ns = (double)gd_field_statistics(entry->cached.field)->build_ns;
    entry->priority = cache->age + build_ns * (double)entry->uses / (double)entry->bytes;
}

/* Takes an entry that left the order off its shelf; the shelf's reference is the caller's to release after the lock. */
static void shelf_remove(struct server_cache *cache, struct entry *entry)
{
    struct entry **link = shelf_bucket(entry->shelf, &entry->source);
    while (*link != entry) link = &(*link)->next;
    *link = entry->next;
    entry->next = NULL;
    entry->shelf->entry_count--;
    cache->statistics.fields--;
}

/* Puts an entry on its shelf, with one more reference for it, if there is memory. */
static void shelf_insert(struct server_cache *cache, struct entry *entry)
{
    if (!shelf_reserve(entry->shelf) || !server_heap_reserve(&cache->order)) return;
    struct entry **bucket = shelf_bucket(entry->shelf, &entry->source);
    entry->next = *bucket;
    *bucket = entry;
    entry->shelf->entry_count++;
    atomic_fetch_add(&entry->references, 1);
    set_priority(cache, entry);
    order_insert(cache, entry);
    cache->statistics.fields++;
}

/* --- eviction, under the lock ------------------------------------------------------------------------------------- */

/* Takes unpinned entries off their shelves, lowest priority first, until they hold `bytes` or none is left.
 * Returns them as a list. */
static struct entry *evict(struct server_cache *cache, size_t bytes)
{
    struct entry *evicted = NULL, *pinned = NULL, *lowest;
    for (size_t freed = 0; freed < bytes && (lowest = order_lowest(cache));) {
        if (atomic_load(&lowest->references) > 1) {
            server_heap_remove(&cache->order, &lowest->node);
            lowest->aside = pinned;
            pinned = lowest;
            continue;
        }
        cache->age = lowest->priority;
        freed += lowest->bytes;
        server_heap_remove(&cache->order, &lowest->node);
        shelf_remove(cache, lowest);
        cache->statistics.evictions++;
        lowest->next = evicted;
        evicted = lowest;
    }
    for (; pinned; pinned = pinned->aside) order_insert(cache, pinned);
    return evicted;
}

static void reclaim(void *user, size_t bytes)
{
    struct server_cache *cache = user;
    pthread_mutex_lock(&cache->lock);
    struct entry *evicted = evict(cache, bytes);
    pthread_mutex_unlock(&cache->lock);
    release_all(evicted);
}

/* --- cache and shelves -------------------------------------------------------------------------------------------- */

struct server_cache *server_cache_create(struct server_budget *budget, struct server_workers *workers)
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
    assert(!cache->order.size && !cache->flights);
    cache->budget->reclaimers[SERVER_RECLAIM_FIELDS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&cache->lock);
    server_heap_free(&cache->order);
    free(cache);
}

struct server_shelf *server_shelf_open(struct server_cache *cache)
{
    struct server_shelf *shelf = calloc(1, sizeof *shelf);
    if (!shelf) return NULL;
    shelf->references = 1;
    shelf->cache = cache;
    return shelf;
}

void server_shelf_close(struct server_shelf *shelf)
{
    struct server_cache *cache = shelf->cache;
    struct entry *removed = NULL;
    pthread_mutex_lock(&cache->lock);
    shelf->closed = true;
    for (uint32_t i = 0; i < shelf->bucket_count; i++) {
        while (shelf->buckets[i]) {
            struct entry *entry = shelf->buckets[i];
            server_heap_remove(&cache->order, &entry->node);
            shelf_remove(cache, entry);
            entry->next = removed;
            removed = entry;
        }
    }
    pthread_mutex_unlock(&cache->lock);
    release_all(removed);
}

static uint32_t pin_all(struct server_shelf *shelf, const struct server_cached **pinned)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < shelf->bucket_count; i++) {
        for (struct entry *entry = shelf->buckets[i]; entry; entry = entry->next) {
            atomic_fetch_add(&entry->references, 1);
            pinned[count++] = &entry->cached;
        }
    }
    return count;
}

const struct server_cached **server_shelf_pin_all(struct server_shelf *shelf, uint32_t *count)
{
    pthread_mutex_lock(&shelf->cache->lock);
    const struct server_cached **pinned =
        shelf->entry_count ? malloc(shelf->entry_count * sizeof(struct server_cached *)) : NULL;
    *count = pinned ? pin_all(shelf, pinned) : 0;
    pthread_mutex_unlock(&shelf->cache->lock);
    return pinned;
}

uint32_t server_shelf_count(struct server_shelf *shelf)
{
    pthread_mutex_lock(&shelf->cache->lock);
    uint32_t count = shelf->entry_count;
    pthread_mutex_unlock(&shelf->cache->lock);
    return count;
}

struct server_cache_statistics server_cache_statistics(struct server_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    struct server_cache_statistics statistics = cache->statistics;
    pthread_mutex_unlock(&cache->lock);
    return statistics;
}

/* --- find --------------------------------------------------------------------------------------------------------- */

const struct server_cached *server_cache_find(struct server_shelf *shelf, const struct gd_point *source)
{
    struct server_cache *cache = shelf->cache;
    pthread_mutex_lock(&cache->lock);
    struct entry *entry = shelf_find(shelf, source);
    if (entry) {
        atomic_fetch_add(&entry->references, 1);
        entry->uses++;
        set_priority(cache, entry);
        cache->statistics.hits++;
    } else {
        cache->statistics.misses++;
    }
    pthread_mutex_unlock(&cache->lock);
    return entry ? &entry->cached : NULL;
}

void server_cache_unpin(const struct server_cached *cached)
{
    if (cached) entry_release((struct entry *)cached);
}

/* --- what is asked about often ------------------------------------------------------------------------------------ */

void server_cache_note(struct server_shelf *shelf, const struct gd_point *point)
{
    pthread_mutex_lock(&shelf->cache->lock);
    server_recent_note(&shelf->recent, point_hash(point));
    pthread_mutex_unlock(&shelf->cache->lock);
}

/* --- flights ------------------------------------------------------------------------------------------------------ */

static struct server_flight *find_flight(struct server_cache *cache, const struct server_shelf *shelf,
                                         const struct gd_point *source)
{
    struct server_flight *flight = cache->flights;
    while (flight && !(flight->shelf == shelf && gd_point_equal(&flight->source, source))) flight = flight->next;
    return flight;
}

static struct server_flight *start_flight(struct server_shelf *shelf, const struct gd_point *source)
{
    struct server_flight *flight = calloc(1, sizeof *flight);
    if (!flight) return NULL;
    atomic_fetch_add(&shelf->references, 1);
    *flight = (struct server_flight){.shelf = shelf, .next = shelf->cache->flights, .source = *source};
    shelf->cache->flights = flight;
    return flight;
}

static bool park(struct server_shelf *shelf, const struct gd_point *source, struct server_job *job)
{
    struct server_flight *flight = find_flight(shelf->cache, shelf, source);
    if (!flight) return false;
    job->next = flight->parked;
    flight->parked = job;
    shelf->cache->statistics.waits++;
    return true;
}

static enum server_cache_turn enter(struct server_shelf *shelf, const struct gd_point *source, struct server_job *job,
                                    struct server_flight **out)
{
    if (shelf_find(shelf, source)) return SERVER_CACHE_AGAIN;
    if (park(shelf, source, job)) return SERVER_CACHE_WAIT;
    if (server_recent_count(&shelf->recent, point_hash(source)) < SERVER_CACHE_SEARCHES) return SERVER_CACHE_SEARCH;
    struct server_flight *flight = start_flight(shelf, source);
    if (!flight) return SERVER_CACHE_SEARCH;
    shelf->cache->statistics.builds++;
    *out = flight;
    return SERVER_CACHE_BUILD;
}

enum server_cache_turn server_cache_enter(struct server_shelf *shelf, const struct gd_point *source,
                                          struct server_job *job, struct server_flight **flight)
{
    pthread_mutex_lock(&shelf->cache->lock);
    enum server_cache_turn turn = enter(shelf, source, job, flight);
    pthread_mutex_unlock(&shelf->cache->lock);
    return turn;
}

bool server_cache_is_awaited(struct server_flight *flight)
{
    pthread_mutex_lock(&flight->shelf->cache->lock);
    bool awaited = flight->parked != NULL;
    pthread_mutex_unlock(&flight->shelf->cache->lock);
    return awaited;
}

/* Takes a flight out of the list; under the lock. */
static void end_flight(struct server_flight *flight)
{
    struct server_flight **link = &flight->shelf->cache->flights;
    while (*link != flight) link = &(*link)->next;
    *link = flight->next;
}

/* Frees a flight that has ended and returns the jobs that were parked on it. */
static struct server_job *flight_free(struct server_flight *flight)
{
    struct server_job *parked = flight->parked;
    server_shelf_release(flight->shelf);
    free(flight);
    return parked;
}

static void resume_all(struct server_workers *workers, struct server_job *job)
{
    while (job) {
        struct server_job *next = job->next;
        server_workers_resume(workers, job);
        job = next;
    }
}

/* A pinned entry, on no shelf as yet, that owns the field and its bytes, so far in flight. NULL without memory: then
 * both are gone. */
static struct entry *create_entry(struct server_shelf *shelf, const struct gd_point *source, struct gd_field *field,
                                  size_t bytes)
{
    struct server_budget *budget = shelf->cache->budget;
    struct entry *entry = malloc(sizeof *entry);
    if (!entry) {
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        gd_field_release(field);
        return NULL;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_FIELDS, bytes);
    atomic_fetch_add(&shelf->references, 1);
    *entry = (struct entry){
        .cached = {field}, .references = 1, .shelf = shelf, .source = *source, .bytes = bytes, .uses = 1};
    return entry;
}

/* Puts an entry on its shelf (NULL: there is none), unless that is closed or has one of that source. Under the lock. */
static void put_on_shelf(struct entry *entry)
{
    if (entry && !entry->shelf->closed && !shelf_find(entry->shelf, &entry->source))
        shelf_insert(entry->shelf->cache, entry);
}

const struct server_cached *server_cache_land(struct server_flight *flight, struct gd_field *field)
{
    struct server_cache *cache = flight->shelf->cache;
    size_t bytes = gd_field_memsize(field);
    struct entry *entry = create_entry(flight->shelf, &flight->source, field, bytes);
    pthread_mutex_lock(&cache->lock);
    end_flight(flight);
    server_recent_forget(&flight->shelf->recent, point_hash(&flight->source));
    put_on_shelf(entry); /* without memory it lives as long as its pins */
    pthread_mutex_unlock(&cache->lock);
    resume_all(cache->workers, flight_free(flight));
    return entry ? &entry->cached : NULL;
}

void server_cache_restore(struct server_shelf *shelf, struct gd_field *field)
{
    struct server_cache *cache = shelf->cache;
    struct gd_point source;
    size_t bytes = gd_field_memsize(field);
    if (!gd_field_single_seed(field, &source)) {
        server_budget_give(cache->budget, SERVER_BUDGET_FLIGHT, bytes);
        gd_field_release(field);
        return;
    }
    struct entry *entry = create_entry(shelf, &source, field, bytes);
    if (!entry) return;
    pthread_mutex_lock(&cache->lock);
    put_on_shelf(entry);
    pthread_mutex_unlock(&cache->lock);
    entry_release(entry);
}

void server_cache_abandon(struct server_flight *flight, bool is_worth_another)
{
    struct server_cache *cache = flight->shelf->cache;
    pthread_mutex_lock(&cache->lock);
    end_flight(flight);
    if (!is_worth_another) server_recent_forget(&flight->shelf->recent, point_hash(&flight->source));
    pthread_mutex_unlock(&cache->lock);
    resume_all(cache->workers, flight_free(flight));
}

void server_cache_expire(struct server_cache *cache, uint64_t now_ns)
{
    struct server_job *expired = NULL, **end = &expired;
    pthread_mutex_lock(&cache->lock);
    for (struct server_flight *flight = cache->flights; flight; flight = flight->next) {
        *end = server_jobs_expire(&flight->parked, now_ns);
        while (*end) end = &(*end)->next;
    }
    pthread_mutex_unlock(&cache->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
