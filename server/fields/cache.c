/* See cache.h. */
#include "server/fields/cache.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/queue.h>

#include "server/fields/hot_points.h"

#define FIRST_BUCKETS 8
#define FAILURE_NS    UINT64_C(1000000000) /* a build that failed is not repeated for so long */

/* The seeds of a field, compared in order and bit by bit, and its reach. Of two fields with equal
 * seeds, the one of larger reach answers all requests of the other. */
struct field_key {
    uint64_t hash; /* of the seeds */
    double radius; /* 0: no limit */
    uint32_t seed_count;
    const struct gd_seed *seeds;
};

struct entry {
    struct server_cached cached; /* first: a pin is a pointer to it */
    atomic_uint references;      /* of the mesh cache and of the pins */
    struct server_mesh_cache *fields;
    struct field_key key; /* owned */
    struct entry *next_in_bucket;
    SLIST_ENTRY(entry) next; /* of the removed entries, or of the pinned ones during an eviction */
};

SLIST_HEAD(entries, entry);

struct server_pending_build {
    LIST_ENTRY(server_pending_build) next;
    struct server_mesh_cache *fields; /* a reference */
    struct field_key key;             /* owned */
    struct server_job *parked;
};

struct failure {
    struct field_key key; /* without seeds */
    uint64_t until_ns;
    enum gd_status status;
};

struct server_mesh_cache {
    atomic_uint references;
    struct server_cache *cache;
    bool is_closed;
    struct entry **buckets;
    uint32_t bucket_count, count;        /* bucket_count is 0 or a power of two */
    struct server_hot_points hot_points; /* asked about while they had no field */
    struct failure failure;              /* the last one */
};

struct server_cache {
    struct server_budget *budget;
    struct server_workers *workers;
    pthread_mutex_t lock;
    struct server_eviction eviction;          /* of all entries in mesh caches */
    LIST_HEAD(, server_pending_build) builds; /* as many as jobs are queued or run, at most */
    struct server_cache_statistics statistics;
};

/* --- keys ------------------------------------------------------------------------------------- */

static uint64_t hash_add(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ hash >> 29;
}

static uint64_t hash_add_number(uint64_t hash, double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return hash_add(hash, bits);
}

static uint64_t hash_add_point(uint64_t hash, const struct gd_point *point)
{
    hash = hash_add(hash_add(hash, (uint64_t)point->kind), point->element);
    for (int i = 0; i < 3; i++) hash = hash_add_number(hash, point->weight[i]);
    return hash;
}

static uint64_t hash_add_seed(uint64_t hash, const struct gd_seed *seed)
{
    hash = hash_add_point(hash, &seed->point);
    if (seed->is_segment) hash = hash_add_point(hash, &seed->end);
    return hash_add_number(hash, seed->offset);
}

static bool is_equal_seed(const struct gd_seed *a, const struct gd_seed *b)
{
    if (!gd_point_equal(&a->point, &b->point) || a->offset != b->offset ||
        a->is_segment != b->is_segment)
        return false;
    return !a->is_segment || gd_point_equal(&a->end, &b->end);
}

static struct field_key key_of(const struct gd_field_request *request)
{
    uint64_t hash = request->seed_count;
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

static struct field_key key_of_point(const struct gd_point *source, struct gd_seed *seed)
{
    *seed = (struct gd_seed){.point = *source};
    return key_of(&(struct gd_field_request){.seeds = seed, .seed_count = 1});
}

static bool key_is_point(const struct field_key *key)
{
    return key->seed_count == 1 && !key->seeds[0].is_segment && key->seeds[0].offset == 0 &&
           key->radius == 0;
}

/* Of keys with equal seeds: `a` reaches at least as far as `b`. */
static bool key_covers(const struct field_key *a, const struct field_key *b)
{
    return a->radius == 0 || (b->radius != 0 && a->radius >= b->radius);
}

/* --- entries, without the lock ---------------------------------------------------------------- */

/* A pinned entry outside its mesh cache; takes over the field and its bytes of
 * SERVER_BUDGET_FLIGHT. NULL without memory: then the field is released. */
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
    entry->cached.field = field;
    entry->cached.worth = (struct server_evictable){
        .cost = (double)gd_field_statistics(field)->build_ns, .bytes = all, .uses = 1};
    return entry;
}

static void entry_release(struct entry *entry)
{
    if (!entry || atomic_fetch_sub(&entry->references, 1) != 1) return;
    server_budget_give(entry->fields->cache->budget, SERVER_BUDGET_FIELDS,
                       entry->cached.worth.bytes);
    gd_field_release(entry->cached.field);
    server_mesh_cache_release(entry->fields);
    key_free(&entry->key);
    free(entry);
}

static void entries_release(struct entries *entries)
{
    for (struct entry *entry; (entry = SLIST_FIRST(entries));) {
        SLIST_REMOVE_HEAD(entries, next);
        entry_release(entry);
    }
}

void server_cache_unpin(const struct server_cached *cached)
{
    entry_release((struct entry *)cached);
}

/* --- a mesh's table of entries, under the lock ------------------------------------------------ */

static struct entry **table_bucket(const struct server_mesh_cache *fields, uint64_t hash)
{
    return &fields->buckets[hash & (fields->bucket_count - 1)];
}

/* The entry of these seeds, of any reach; or NULL. */
static struct entry *table_find(const struct server_mesh_cache *fields, const struct field_key *key)
{
    if (!fields->bucket_count) return NULL;
    struct entry *entry = *table_bucket(fields, key->hash);
    while (entry && !key_equal(&entry->key, key)) entry = entry->next_in_bucket;
    return entry;
}

/* The entry of these seeds if it reaches at least as far as `key`. */
static struct entry *table_find_covering(const struct server_mesh_cache *fields,
                                         const struct field_key *key)
{
    struct entry *entry = table_find(fields, key);
    return entry && key_covers(&entry->key, key) ? entry : NULL;
}

static void table_push(struct server_mesh_cache *fields, struct entry *entry)
{
    struct entry **bucket = table_bucket(fields, entry->key.hash);
    entry->next_in_bucket = *bucket;
    *bucket = entry;
}

/* Makes room for one more; false without memory. */
static bool table_reserve(struct server_mesh_cache *fields)
{
    if (fields->count < fields->bucket_count) return true;
    struct entry **before = fields->buckets;
    uint32_t before_count = fields->bucket_count;
    uint32_t bucket_count = before_count ? 2 * before_count : FIRST_BUCKETS;
    struct entry **buckets = calloc(bucket_count, sizeof *buckets);
    if (!buckets) return false;
    fields->buckets = buckets;
    fields->bucket_count = bucket_count;
    for (uint32_t i = 0; i < before_count; i++) {
        for (struct entry *entry = before[i], *next; entry; entry = next) {
            next = entry->next_in_bucket;
            table_push(fields, entry);
        }
    }
    free(before);
    return true;
}

/* Removes an entry that is no longer in the order of eviction; the caller releases it without the
 * lock. */
static void table_remove(struct entry *entry)
{
    struct entry **link = table_bucket(entry->fields, entry->key.hash);
    while (*link != entry) link = &(*link)->next_in_bucket;
    *link = entry->next_in_bucket;
    entry->fields->count--;
    entry->fields->cache->statistics.fields--;
}

/* Removes an entry from table and order; the caller releases it without the lock. */
static void entry_withdraw(struct entry *entry)
{
    server_heap_remove(&entry->fields->cache->eviction.order, &entry->cached.worth.node);
    table_remove(entry);
}

/* Adds an entry (NULL is harmless), with one more reference, to table and order, unless the mesh
 * cache is closed, or has a field of these seeds that reaches as far, or memory is short. Returns
 * the entry that it replaces, for the caller to release without the lock; or NULL. */
static struct entry *entry_put(struct entry *entry)
{
    if (!entry || entry->fields->is_closed || table_find_covering(entry->fields, &entry->key))
        return NULL;
    struct server_cache *cache = entry->fields->cache;
    if (!table_reserve(entry->fields) || !server_heap_reserve(&cache->eviction.order)) return NULL;
    struct entry *nearer = table_find(entry->fields, &entry->key);
    if (nearer) {
        entry->cached.worth.uses += nearer->cached.worth.uses;
        entry_withdraw(nearer);
    }
    atomic_fetch_add(&entry->references, 1);
    table_push(entry->fields, entry);
    entry->fields->count++;
    cache->statistics.fields++;
    server_eviction_insert(&cache->eviction, &entry->cached.worth);
    return nearer;
}

/* --- eviction --------------------------------------------------------------------------------- */

static struct entry *entry_of_worth(struct server_evictable *worth)
{
    return worth ? (struct entry *)((char *)worth - offsetof(struct entry, cached.worth)) : NULL;
}

/* Under the lock: removes unpinned entries in the order of eviction until they hold `bytes` or none
 * is left. */
static struct entries cache_evict(struct server_cache *cache, size_t bytes)
{
    struct entries evicted = SLIST_HEAD_INITIALIZER(evicted), pinned = evicted;
    struct server_eviction *eviction = &cache->eviction;
    struct entry *first;
    for (size_t freed = 0;
         freed < bytes && (first = entry_of_worth(server_eviction_first(eviction)));) {
        if (atomic_load(&first->references) > 1) {
            server_heap_remove(&eviction->order, &first->cached.worth.node);
            SLIST_INSERT_HEAD(&pinned, first, next);
            continue;
        }
        server_eviction_evict(eviction, &first->cached.worth);
        table_remove(first);
        SLIST_INSERT_HEAD(&evicted, first, next);
        freed += first->cached.worth.bytes;
        cache->statistics.evictions++;
    }
    SLIST_FOREACH(first, &pinned, next) server_eviction_insert(eviction, &first->cached.worth);
    return evicted;
}

static void cache_reclaim(void *user, size_t bytes)
{
    struct server_cache *cache = user;
    pthread_mutex_lock(&cache->lock);
    struct entries evicted = cache_evict(cache, bytes);
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
    assert(!cache->eviction.order.size && LIST_EMPTY(&cache->builds));
    cache->budget->reclaimers[SERVER_RECLAIM_FIELDS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&cache->lock);
    server_heap_free(&cache->eviction.order);
    free(cache);
}

struct server_cache_statistics server_cache_statistics(struct server_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    struct server_cache_statistics statistics = cache->statistics;
    pthread_mutex_unlock(&cache->lock);
    return statistics;
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
    if (atomic_fetch_sub(&fields->references, 1) != 1) return;
    free(fields->buckets);
    free(fields);
}

void server_mesh_cache_close(struct server_mesh_cache *fields)
{
    struct entries removed = SLIST_HEAD_INITIALIZER(removed);
    pthread_mutex_lock(&fields->cache->lock);
    fields->is_closed = true;
    for (uint32_t i = 0; i < fields->bucket_count; i++) {
        for (struct entry *entry; (entry = fields->buckets[i]);) {
            entry_withdraw(entry);
            SLIST_INSERT_HEAD(&removed, entry, next);
        }
    }
    pthread_mutex_unlock(&fields->cache->lock);
    entries_release(&removed);
}

/* Under the lock. */
static uint32_t entries_pin_points(struct server_mesh_cache *fields,
                                   const struct server_cached **pinned)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < fields->bucket_count; i++) {
        for (struct entry *entry = fields->buckets[i]; entry; entry = entry->next_in_bucket) {
            if (!key_is_point(&entry->key)) continue;
            atomic_fetch_add(&entry->references, 1);
            pinned[count++] = &entry->cached;
        }
    }
    return count;
}

const struct server_cached **server_mesh_cache_pin_points(struct server_mesh_cache *fields,
                                                          uint32_t *count)
{
    pthread_mutex_lock(&fields->cache->lock);
    const struct server_cached **pinned =
        fields->count ? malloc(fields->count * sizeof(struct server_cached *)) : NULL;
    *count = pinned ? entries_pin_points(fields, pinned) : 0;
    pthread_mutex_unlock(&fields->cache->lock);
    return pinned;
}

uint32_t server_mesh_cache_count(struct server_mesh_cache *fields)
{
    pthread_mutex_lock(&fields->cache->lock);
    uint32_t count = fields->count;
    pthread_mutex_unlock(&fields->cache->lock);
    return count;
}

/* --- finding ---------------------------------------------------------------------------------- */

static const struct server_cached *entry_find(struct server_mesh_cache *fields,
                                              const struct field_key *key)
{
    struct server_cache *cache = fields->cache;
    pthread_mutex_lock(&cache->lock);
    struct entry *entry = table_find_covering(fields, key);
    if (entry) {
        atomic_fetch_add(&entry->references, 1);
        server_eviction_use(&cache->eviction, &entry->cached.worth);
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
    struct field_key key = key_of(request);
    return entry_find(fields, &key);
}

const struct server_cached *server_cache_find(struct server_mesh_cache *fields,
                                              const struct gd_point *source)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(source, &seed);
    return entry_find(fields, &key);
}

void server_cache_drop(struct server_mesh_cache *fields, const struct gd_field_request *request)
{
    struct field_key key = key_of(request);
    pthread_mutex_lock(&fields->cache->lock);
    struct entry *entry = table_find(fields, &key);
    if (entry && entry->key.radius != key.radius) entry = NULL;
    if (entry) entry_withdraw(entry);
    pthread_mutex_unlock(&fields->cache->lock);
    entry_release(entry);
}

/* --- claiming a build ------------------------------------------------------------------------- */

void server_cache_note(struct server_mesh_cache *fields, const struct gd_point *point)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(point, &seed);
    pthread_mutex_lock(&fields->cache->lock);
    server_hot_points_note(&fields->hot_points, key.hash);
    pthread_mutex_unlock(&fields->cache->lock);
}

/* Under the lock: of the builds of these seeds that reach no farther, the one that reaches
 * farthest; or NULL. */
static struct server_pending_build *pending_find(const struct server_mesh_cache *fields,
                                                 const struct field_key *key)
{
    struct server_pending_build *build, *found = NULL;
    LIST_FOREACH(build, &fields->cache->builds, next)
    {
        if (build->fields != fields || !key_equal(&build->key, key)) continue;
        if (!key_covers(key, &build->key)) continue;
        if (!found || key_covers(&build->key, &found->key)) found = build;
    }
    return found;
}

/* Under the lock: AGAIN, or WAIT for a build of this field or of one that it can be resumed from;
 * else SEARCH. */
static enum server_cache_turn build_join(struct server_mesh_cache *fields,
                                         const struct field_key *key, struct server_job *job)
{
    if (table_find_covering(fields, key)) return SERVER_CACHE_AGAIN;
    struct server_pending_build *build = pending_find(fields, key);
    if (!build) return SERVER_CACHE_SEARCH;
    job->next = build->parked;
    build->parked = job;
    fields->cache->statistics.waits++;
    return SERVER_CACHE_WAIT;
}

/* Under the lock: BUILD, or SEARCH without memory. */
static enum server_cache_turn build_begin(struct server_mesh_cache *fields,
                                          const struct field_key *key,
                                          struct server_pending_build **out)
{
    struct server_pending_build *build = calloc(1, sizeof *build);
    if (!build || !key_copy(key, &build->key)) {
        free(build);
        return SERVER_CACHE_SEARCH;
    }
    build->fields = fields;
    atomic_fetch_add(&fields->references, 1);
    LIST_INSERT_HEAD(&fields->cache->builds, build, next);
    fields->cache->statistics.builds++;
    *out = build;
    return SERVER_CACHE_BUILD;
}

enum server_cache_turn server_cache_enter(struct server_mesh_cache *fields,
                                          const struct gd_point *source, struct server_job *job,
                                          struct server_pending_build **build)
{
    struct gd_seed seed;
    struct field_key key = key_of_point(source, &seed);
    pthread_mutex_lock(&fields->cache->lock);
    enum server_cache_turn turn = build_join(fields, &key, job);
    if (turn == SERVER_CACHE_SEARCH &&
        server_hot_points_count(&fields->hot_points, key.hash) >= SERVER_CACHE_SEARCHES)
        turn = build_begin(fields, &key, build);
    pthread_mutex_unlock(&fields->cache->lock);
    return turn;
}

enum server_cache_turn server_cache_claim(struct server_mesh_cache *fields,
                                          const struct gd_field_request *request,
                                          struct server_job *job,
                                          struct server_pending_build **build, enum gd_status *why)
{
    struct field_key key = key_of(request);
    pthread_mutex_lock(&fields->cache->lock);
    const struct failure *failure = &fields->failure;
    bool has_failed = failure->key.hash == key.hash && key_covers(&key, &failure->key) &&
                      gd_now_ns() < failure->until_ns;
    enum server_cache_turn turn = build_join(fields, &key, job);
    if (turn == SERVER_CACHE_SEARCH && !has_failed) turn = build_begin(fields, &key, build);
    if (turn == SERVER_CACHE_SEARCH) *why = has_failed ? failure->status : GD_NO_MEMORY;
    pthread_mutex_unlock(&fields->cache->lock);
    return turn;
}

const struct server_cached *server_cache_find_nearer(struct server_pending_build *build)
{
    struct server_cache *cache = build->fields->cache;
    pthread_mutex_lock(&cache->lock);
    struct entry *entry = table_find(build->fields, &build->key);
    if (entry && key_covers(&entry->key, &build->key)) entry = NULL;
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
    bool is_awaited = build->parked != NULL;
    pthread_mutex_unlock(&build->fields->cache->lock);
    return is_awaited;
}

/* --- ending a build --------------------------------------------------------------------------- */

/* Under the lock: after this no job is parked on the build. Only a whole field resets the questions
 * that were counted. */
static void pending_remove(struct server_pending_build *build, bool resets_questions)
{
    LIST_REMOVE(build, next);
    if (resets_questions && build->key.radius == 0)
        server_hot_points_forget(&build->fields->hot_points, build->key.hash);
}

/* Frees a removed build and resumes its parked jobs. */
static void pending_free(struct server_pending_build *build)
{
    for (struct server_job *job = build->parked, *next; job; job = next) {
        next = job->next;
        server_workers_resume(build->fields->cache->workers, job);
    }
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
    struct entry *entry = entry_create(fields, key, field);
    pthread_mutex_lock(&fields->cache->lock);
    if (build) pending_remove(build, true);
    struct entry *replaced = entry_put(entry);
    pthread_mutex_unlock(&fields->cache->lock);
    entry_release(replaced);
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
    struct field_key key = key_of_point(&source, &seed);
    server_cache_unpin(field_publish(fields, &key, field, NULL));
}

void server_cache_fail(struct server_pending_build *build, enum gd_status status)
{
    struct server_mesh_cache *fields = build->fields;
    struct server_cache *cache = fields->cache;
    bool is_final = status != GD_CANCELLED && status != GD_DEADLINE;
    pthread_mutex_lock(&cache->lock);
    pending_remove(build, is_final);
    if (is_final)
        fields->failure =
            (struct failure){.key = {.hash = build->key.hash, .radius = build->key.radius},
                             .until_ns = gd_now_ns() + FAILURE_NS,
                             .status = status};
    pthread_mutex_unlock(&cache->lock);
    pending_free(build);
}

void server_cache_expire(struct server_cache *cache, uint64_t now_ns)
{
    struct server_job *expired = NULL, **end = &expired;
    struct server_pending_build *build;
    pthread_mutex_lock(&cache->lock);
    LIST_FOREACH(build, &cache->builds, next)
    {
        *end = server_jobs_expire(&build->parked, now_ns);
        while (*end) end = &(*end)->next;
    }
    pthread_mutex_unlock(&cache->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
