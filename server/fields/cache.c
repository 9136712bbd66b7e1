#include "server/fields/cache.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/queue.h>

#include "server/base/thread.h"
#include "server/fields/hot_points.h"

#define BUCKETS 4096
/* number of entries in the sample from which one entry is evicted */
#define SAMPLE         64
#define FAILURE_NS     UINT64_C(1000000000) /* time after a failed build before it is repeated */
#define MOST_DOUBLINGS 16

/* The seeds and the reach of a field. Seeds are compared in order and bit by bit. Of two fields
 * with equal seeds, the field of larger reach can answer all requests for the other field. */
struct field_key {
    uint64_t hash; /* hash of the seeds */
    double radius; /* 0 means no limit */
    uint32_t seed_count;
    const struct gd_seed *seeds;
};

struct entry {
    /* must be the first member: a pin is a pointer to it, and is cast to the entry */
    struct server_cached cached;
    atomic_uint references; /* references of the mesh cache and of the pins */
    struct server_mesh_cache *fields;
    struct field_key key; /* owned */
    size_t bytes;
    uint64_t uses;
    double priority; /* see cache.h */
    LIST_ENTRY(entry) in_bucket;
    LIST_ENTRY(entry) next; /* link in the mesh cache's list, or in a list of removed entries */
};

LIST_HEAD(entries, entry);

struct server_pending_build {
    LIST_ENTRY(server_pending_build) next;
    struct server_mesh_cache *fields; /* a reference */
    struct field_key key;             /* owned */
};

struct failure {
    struct field_key key; /* the key without its seeds */
    uint64_t until_ns;
    enum gd_status status;
};

struct server_mesh_cache {
    atomic_uint references;
    struct server_cache *cache;
    bool is_closed;
    struct entries entries;
    uint32_t count;
    struct server_hot_points hot_points; /* queried points without a field */
    /* number of builds that failed since the last field; SERVER_CACHE_SEARCHES is doubled once for
       each of them */
    uint32_t doublings;
    struct failure failure; /* the last failure */
};

struct server_cache {
    struct server_budget *budget;
    struct server_workers *workers;
    pthread_mutex_t lock;
    struct entries buckets[BUCKETS]; /* entries of all mesh caches, by hash */
    uint32_t hand;                   /* the bucket where the next sample begins */
    double age;                      /* the priority of the last entry that was evicted */
    /* at most as many as there are queued and running jobs */
    LIST_HEAD(, server_pending_build) builds;
    struct server_cache_statistics statistics;
};

/* --- keys ------------------------------------------------------------------------------------- */

/* struct gd_point has no padding */
#define POINT_WORDS (sizeof(struct gd_point) / sizeof(uint64_t))

static uint64_t hash_add(uint64_t hash, const void *words, size_t count)
{
    for (const char *at = words; count--; at += sizeof(uint64_t)) {
        uint64_t word;
        memcpy(&word, at, sizeof word);
        hash = (hash ^ word) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 29;
    }
    return hash;
}

static uint64_t hash_add_seed(uint64_t hash, const struct gd_seed *seed)
{
    hash = hash_add(hash, &seed->point, POINT_WORDS);
    if (seed->is_segment) hash = hash_add(hash, &seed->end, POINT_WORDS);
    return hash_add(hash, &seed->offset, 1);
}

static bool is_equal_seed(const struct gd_seed *a, const struct gd_seed *b)
{
    return gd_point_equal(&a->point, &b->point) && a->offset == b->offset &&
           a->is_segment == b->is_segment && (!a->is_segment || gd_point_equal(&a->end, &b->end));
}

static struct field_key key_of(const struct server_mesh_cache *fields,
                               const struct gd_field_request *request)
{
    uint64_t hash = (uintptr_t)fields ^ request->seed_count;
    for (uint32_t i = 0; i < request->seed_count; i++)
        hash = hash_add_seed(hash, &request->seeds[i]);
    return (struct field_key){hash, request->radius, request->seed_count, request->seeds};
}

static bool key_equal(const struct field_key *a, const struct field_key *b)
{
    if (a->hash != b->hash || a->seed_count != b->seed_count) return false;
    for (uint32_t i = 0; i < a->seed_count; i++)
        if (!is_equal_seed(&a->seeds[i], &b->seeds[i])) return false;
    return true;
}

static bool key_copy(const struct field_key *key, struct field_key *out)
{
    struct gd_seed *seeds = malloc(key->seed_count * sizeof *seeds);
    if (!seeds) return false;
    memcpy(seeds, key->seeds, key->seed_count * sizeof *seeds);
    *out = *key;
    out->seeds = seeds;
    return true;
}

static void key_free(struct field_key *key)
{
    free((struct gd_seed *)key->seeds);
}

static struct field_key key_of_point(const struct server_mesh_cache *fields,
                                     const struct gd_point *source, struct gd_seed *seed)
{
    *seed = (struct gd_seed){.point = *source};
    return key_of(fields, &(struct gd_field_request){.seeds = seed, .seed_count = 1});
}

static bool key_is_point(const struct field_key *key)
{
    return key->seed_count == 1 && !key->seeds[0].is_segment && key->seeds[0].offset == 0 &&
           key->radius == 0;
}

/* Returns true if `a`, which has the same seeds as `b`, reaches at least as far. */
static bool key_covers(const struct field_key *a, const struct field_key *b)
{
    return a->radius == 0 || (b->radius != 0 && a->radius >= b->radius);
}

/* --- entries, without the lock ---------------------------------------------------------------- */

/* Creates a pinned entry outside its mesh cache. Takes over the field and its bytes of
 * SERVER_BUDGET_FLIGHT. If out of memory, releases the field and returns NULL. */
static struct entry *entry_create(struct server_mesh_cache *fields, const struct field_key *key,
                                  struct gd_field *field)
{
    struct server_budget *budget = fields->cache->budget;
    size_t bytes = gd_field_memsize(field);
    size_t all = bytes + sizeof(struct entry) + key->seed_count * sizeof *key->seeds;
    struct entry *entry = calloc(1, sizeof *entry);
    if (!entry || !key_copy(key, &entry->key)) {
        free(entry);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        gd_field_release(field);
        return NULL;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_FIELDS, bytes);
    server_budget_adjust(budget, SERVER_BUDGET_FIELDS, bytes, all);
    atomic_fetch_add(&fields->references, 1);
    atomic_init(&entry->references, 1);
    entry->fields = fields;
    entry->cached = (struct server_cached){field, (double)gd_field_statistics(field)->build_ns};
    entry->bytes = all;
    entry->uses = 1;
    return entry;
}

static void entry_release(struct entry *entry)
{
    if (!entry || atomic_fetch_sub(&entry->references, 1) != 1) return;
    server_budget_give(entry->fields->cache->budget, SERVER_BUDGET_FIELDS, entry->bytes);
    gd_field_release(entry->cached.field);
    server_mesh_cache_release(entry->fields);
    key_free(&entry->key);
    free(entry);
}

static void entries_release(struct entries *entries)
{
    for (struct entry *entry; (entry = LIST_FIRST(entries));) {
        LIST_REMOVE(entry, next);
        entry_release(entry);
    }
}

void server_cache_unpin(const struct server_cached *cached)
{
    entry_release((struct entry *)cached);
}

/* --- entries, under the lock ------------------------------------------------------------------ */

static struct entries *bucket_of(struct server_cache *cache, const struct field_key *key)
{
    return &cache->buckets[key->hash % BUCKETS];
}

/* Returns the entry of these seeds, whatever its reach, or NULL. */
static struct entry *table_find(const struct server_mesh_cache *fields, const struct field_key *key)
{
    struct entry *entry;
    LIST_FOREACH(entry, bucket_of(fields->cache, key), in_bucket)
    if (entry->fields == fields && key_equal(&entry->key, key)) break;
    return entry;
}

/* Returns the entry of these seeds if it reaches at least as far as `key`. */
static struct entry *table_find_covering(const struct server_mesh_cache *fields,
                                         const struct field_key *key)
{
    struct entry *entry = table_find(fields, key);
    return entry && key_covers(&entry->key, key) ? entry : NULL;
}

/* Moves an entry to the list `removed`. The caller releases it without the lock. */
static void entry_withdraw(struct entry *entry, struct entries *removed)
{
    LIST_REMOVE(entry, in_bucket);
    LIST_REMOVE(entry, next);
    LIST_INSERT_HEAD(removed, entry, next);
    entry->fields->count--;
    entry->fields->cache->statistics.fields--;
}

static void entry_rate(struct entry *entry)
{
    entry->priority =
        entry->fields->cache->age + entry->cached.cost * (double)entry->uses / (double)entry->bytes;
}

/* Adds an entry, with one more reference. Does nothing if the entry is NULL, if the mesh cache is
 * closed, or if the cache has a field of these seeds with at least this reach. Withdraws an entry
 * that the new one replaces. */
static void entry_put(struct entry *entry, struct entries *removed)
{
    if (!entry || entry->fields->is_closed || table_find_covering(entry->fields, &entry->key))
        return;
    struct server_cache *cache = entry->fields->cache;
    struct entry *nearer = table_find(entry->fields, &entry->key);
    if (nearer) {
        entry->uses += nearer->uses;
        entry_withdraw(nearer, removed);
    }
    atomic_fetch_add(&entry->references, 1);
    LIST_INSERT_HEAD(bucket_of(cache, &entry->key), entry, in_bucket);
    LIST_INSERT_HEAD(&entry->fields->entries, entry, next);
    entry->fields->count++;
    cache->statistics.fields++;
    entry_rate(entry);
}

/* Pins the entry, which may be NULL, for a caller. */
static const struct server_cached *entry_pin(struct entry *entry)
{
    if (!entry) return NULL;
    atomic_fetch_add(&entry->references, 1);
    return &entry->cached;
}

/* --- eviction --------------------------------------------------------------------------------- */

/* Returns the entry of the lowest priority among the next SAMPLE entries without pins, or NULL. */
static struct entry *entry_choose(struct server_cache *cache)
{
    struct entry *entry, *chosen = NULL;
    int seen = 0;
    for (uint32_t i = 0; i < BUCKETS && seen < SAMPLE; i++) {
        LIST_FOREACH(entry, &cache->buckets[cache->hand++ % BUCKETS], in_bucket)
        {
            if (atomic_load(&entry->references) > 1) continue;
            if (!chosen || entry->priority < chosen->priority) chosen = entry;
            seen++;
        }
    }
    return chosen;
}

/* Removes unpinned entries until they hold `bytes` or none is left. */
static void cache_reclaim(void *user, size_t bytes)
{
    struct server_cache *cache = user;
    struct entries evicted = LIST_HEAD_INITIALIZER(evicted);
    struct entry *entry;
    pthread_mutex_lock(&cache->lock);
    for (size_t freed = 0; freed < bytes && (entry = entry_choose(cache));) {
        cache->age = entry->priority;
        freed += entry->bytes;
        entry_withdraw(entry, &evicted);
        cache->statistics.evictions++;
    }
    pthread_mutex_unlock(&cache->lock);
    entries_release(&evicted);
}

/* --- cache and mesh caches -------------------------------------------------------------------- */

struct server_cache *server_cache_create(struct server_budget *budget,
                                         struct server_workers *workers)
{
    struct server_cache *cache = calloc(1, sizeof *cache);
    if (!cache) return NULL;
    pthread_mutex_init(&cache->lock, NULL);
    cache->budget = budget;
    cache->workers = workers;
    budget->reclaimers[SERVER_RECLAIM_FIELDS] =
        (struct server_reclaimer){cache_reclaim, NULL, cache};
    return cache;
}

void server_cache_destroy(struct server_cache *cache)
{
    if (!cache) return;
    assert(!cache->statistics.fields && LIST_EMPTY(&cache->builds));
    cache->budget->reclaimers[SERVER_RECLAIM_FIELDS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&cache->lock);
    free(cache);
}

struct server_cache_statistics server_cache_statistics(struct server_cache *cache)
{
    SERVER_LOCK(&cache->lock);
    return cache->statistics;
}

struct server_mesh_cache *server_mesh_cache_open(struct server_cache *cache)
{
    struct server_mesh_cache *fields = calloc(1, sizeof *fields);
    if (!fields) return NULL;
    fields->references = 1;
    fields->cache = cache;
    return fields;
}

void server_mesh_cache_release(struct server_mesh_cache *fields)
{
    if (atomic_fetch_sub(&fields->references, 1) == 1) free(fields);
}

void server_mesh_cache_close(struct server_mesh_cache *fields)
{
    struct entries removed = LIST_HEAD_INITIALIZER(removed);
    pthread_mutex_lock(&fields->cache->lock);
    fields->is_closed = true;
    while (!LIST_EMPTY(&fields->entries)) entry_withdraw(LIST_FIRST(&fields->entries), &removed);
    pthread_mutex_unlock(&fields->cache->lock);
    entries_release(&removed);
}

const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count)
{
    struct entry *entry;
    *count = 0;
    SERVER_LOCK(&fields->cache->lock);
    const struct server_cached **pinned =
        fields->count ? malloc(fields->count * sizeof(struct server_cached *)) : NULL;
    LIST_FOREACH(entry, &fields->entries, next)
    if (pinned && key_is_point(&entry->key)) pinned[(*count)++] = entry_pin(entry);
    return pinned;
}

uint32_t server_mesh_cache_count(struct server_mesh_cache *fields)
{
    SERVER_LOCK(&fields->cache->lock);
    return fields->count;
}

/* --- finding ---------------------------------------------------------------------------------- */

static const struct server_cached *entry_find(struct server_mesh_cache *fields,
                                              const struct field_key *key)
{
    struct server_cache *cache = fields->cache;
    SERVER_LOCK(&cache->lock);
    struct entry *entry = table_find_covering(fields, key);
    *(entry ? &cache->statistics.hits : &cache->statistics.misses) += 1;
    if (entry) {
        entry->uses++;
        entry_rate(entry);
    }
    return entry_pin(entry);
}

const struct server_cached *server_cache_find_field(struct server_mesh_cache *fields,
                                                    const struct gd_field_request *request)
{
    struct field_key key = key_of(fields, request);
    return entry_find(fields, &key);
}

const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(fields, source, &seed);
    return entry_find(fields, &key);
}

void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request)
{
    struct entries removed = LIST_HEAD_INITIALIZER(removed);
    struct field_key key = key_of(fields, request);
    pthread_mutex_lock(&fields->cache->lock);
    struct entry *entry = table_find(fields, &key);
    if (entry && entry->key.radius == key.radius) entry_withdraw(entry, &removed);
    pthread_mutex_unlock(&fields->cache->lock);
    entries_release(&removed);
}

/* --- claiming a build ------------------------------------------------------------------------- */

void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(fields, point, &seed);
    SERVER_LOCK(&fields->cache->lock);
    server_hot_points_note(&fields->hot_points, key.hash);
}

/* Returns the build of these seeds and this reach, or NULL. Called under the lock. */
static struct server_pending_build *pending_find(const struct server_mesh_cache *fields,
                                                 const struct field_key *key)
{
    struct server_pending_build *build;
    LIST_FOREACH(build, &fields->cache->builds, next)
    if (build->fields == fields && key_equal(&build->key, key) && build->key.radius == key->radius)
        break;
    return build;
}

/* Called under the lock. Returns AGAIN if the field exists. Returns WAIT if this field is being
 * built. Otherwise returns BUILD if `may_build` is true and memory suffices, else SEARCH. After a
 * cancel of the workers, and without a job, returns SEARCH instead of WAIT. */
static enum server_cache_turn build_claim(struct server_mesh_cache *fields,
                                          const struct field_key *key, struct server_job *job,
                                          bool may_build, struct server_pending_build **out)
{
    struct server_cache *cache = fields->cache;
    struct server_pending_build *build = pending_find(fields, key);
    if (table_find_covering(fields, key)) return SERVER_CACHE_AGAIN;
    if (build && !job) return SERVER_CACHE_SEARCH;
    if (build) {
        cache->statistics.waits++;
        return server_workers_park(cache->workers, job, build, 0) ? SERVER_CACHE_WAIT
                                                                  : SERVER_CACHE_SEARCH;
    }
    if (may_build) build = calloc(1, sizeof *build);
    if (!build || !key_copy(key, &build->key)) {
        free(build);
        return SERVER_CACHE_SEARCH;
    }
    build->fields = fields;
    atomic_fetch_add(&fields->references, 1);
    LIST_INSERT_HEAD(&cache->builds, build, next);
    cache->statistics.builds++;
    *out = build;
    return SERVER_CACHE_BUILD;
}

enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(fields, source, &seed);
    SERVER_LOCK(&fields->cache->lock);
    bool is_hot = server_hot_points_count(&fields->hot_points, key.hash) >> fields->doublings >=
                  SERVER_CACHE_SEARCHES;
    return build_claim(fields, &key, job, is_hot, build);
}

enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why)
{
    struct field_key key = key_of(fields, request);
    SERVER_LOCK(&fields->cache->lock);
    const struct failure *failure = &fields->failure;
    bool has_failed = failure->key.hash == key.hash && key_covers(&key, &failure->key) &&
                      gd_now_ns() < failure->until_ns;
    enum server_cache_turn turn = build_claim(fields, &key, job, !has_failed, build);
    *why = has_failed                                         ? failure->status
           : server_workers_cancelled(fields->cache->workers) ? GD_CANCELLED
                                                              : GD_NO_MEMORY;
    return turn;
}

bool server_cache_is_awaited(struct server_pending_build *build)
{
    return server_workers_await(build->fields->cache->workers, build);
}

/* --- ending a build --------------------------------------------------------------------------- */

/* Under the lock: removes a build. The count of queries is reset only after a complete field. */
static void pending_remove(struct server_pending_build *build, bool resets_count)
{
    LIST_REMOVE(build, next);
    if (resets_count && build->key.radius == 0)
        server_hot_points_forget(&build->fields->hot_points, build->key.hash);
}

/* Frees a removed build and resumes its parked jobs. */
static void pending_free(struct server_pending_build *build)
{
    server_workers_unpark(build->fields->cache->workers, build);
    server_mesh_cache_release(build->fields);
    key_free(&build->key);
    free(build);
}

/* Adds a field, the result of `build` if that is not NULL, and returns it pinned. */
static const struct server_cached *field_publish(struct server_mesh_cache *fields,
                                                 const struct field_key *key,
                                                 struct gd_field *field,
                                                 struct server_pending_build *build)
{
    struct entries replaced = LIST_HEAD_INITIALIZER(replaced);
    struct entry *entry = entry_create(fields, key, field);
    pthread_mutex_lock(&fields->cache->lock);
    if (build) pending_remove(build, true);
    if (entry) fields->doublings = 0;
    entry_put(entry, &replaced);
    pthread_mutex_unlock(&fields->cache->lock);
    entries_release(&replaced);
    if (build) pending_free(build);
    return entry ? &entry->cached : NULL;
}

const struct server_cached *server_cache_publish(struct server_pending_build *build,
                                                 struct gd_field *field)
{
    return field_publish(build->fields, &build->key, field, build);
}

void server_cache_restore(struct server_mesh_cache *fields, struct gd_field *field)
{
    struct gd_point source;
    struct gd_seed seed;
    if (!gd_field_single_seed(field, &source)) {
        server_budget_give(fields->cache->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field));
        gd_field_release(field);
        return;
    }
    struct field_key key = key_of_point(fields, &source, &seed);
    server_cache_unpin(field_publish(fields, &key, field, NULL));
}

void server_cache_abandon(struct server_pending_build *build)
{
    struct server_mesh_cache *fields = build->fields;
    pthread_mutex_lock(&fields->cache->lock);
    pending_remove(build, true);
    fields->doublings += fields->doublings < MOST_DOUBLINGS;
    pthread_mutex_unlock(&fields->cache->lock);
    pending_free(build);
}

void server_cache_fail(struct server_pending_build *build, enum gd_status status)
{
    struct server_mesh_cache *fields = build->fields;
    struct server_cache *cache = fields->cache;
    bool is_final = status != GD_CANCELLED && status != GD_DEADLINE;
    pthread_mutex_lock(&cache->lock);
    pending_remove(build, is_final);
    fields->doublings += is_final && fields->doublings < MOST_DOUBLINGS;
    if (is_final)
        fields->failure =
            (struct failure){.key = {.hash = build->key.hash, .radius = build->key.radius},
                             .until_ns = gd_now_ns() + FAILURE_NS,
                             .status = status};
    pthread_mutex_unlock(&cache->lock);
    pending_free(build);
}
