/* What the cache is made of: mesh_cache.c has the fields of one mesh, cache.c what they have in
 * common. Included by those two and by the cache's test, which says what a build took. */
#ifndef SERVER_FIELDS_CACHE_PARTS_H
#define SERVER_FIELDS_CACHE_PARTS_H

#include <pthread.h>
#include <stddef.h>

#include "server/fields/cache.h"
#include "server/fields/eviction.h"
#include "server/fields/field_table.h"
#include "server/fields/pending_builds.h"
#include "server/fields/hot_points.h"

struct server_entry {
    struct server_cached cached; /* first: a pin is a pointer to it */
    atomic_uint references;      /* the mesh cache's and the pins' */
    struct server_mesh_cache *fields;
    struct server_field_slot slot; /* on the mesh cache; its key is owned */
    /* in a list of entries that left their mesh caches, or that an eviction passes over */
    struct server_entry *next;
    struct server_evictable worth; /* its bytes stay in the budget until the last reference goes */
};

/* A build that failed. Who waited for it, or wants a field that reaches as far, learns so instead
 * of trying it in his turn. */
struct server_failure {
    uint64_t hash, until_ns;
    double radius; /* 0: no limit */
    enum gd_status status;
};

struct server_mesh_cache {
    atomic_uint references;
    struct server_cache *cache;
    bool closed;
    struct server_field_table entries;
    struct server_hot_points hot_points; /* points that had no field when they were asked about */
    struct server_failure failure;       /* the last one */
};

struct server_cache {
    struct server_budget *budget;
    struct server_workers *workers;
    pthread_mutex_t lock;
    struct server_eviction eviction; /* of all entries on mesh caches */
    struct server_pending_builds builds;
    struct server_cache_statistics statistics;
};

/* --- entries, mesh_cache.c -------------------------------------------------------------------- */

/* A pinned entry, on no mesh cache as yet, that owns the field and its bytes, so far in flight.
 * NULL without memory: then both are gone. */
struct server_entry *server_entry_create(struct server_mesh_cache *fields,
                                         const struct server_field_key *key,
                                         struct gd_field *field);

/* May free a field: not under the lock. */
void server_entry_release(struct server_entry *entry);

/* Releases a list of entries that were taken off their mesh caches. */
void server_entries_release(struct server_entry *entry);

static inline struct server_entry *server_entry_of(struct server_evictable *worth)
{
    return worth ? (struct server_entry *)((char *)worth - offsetof(struct server_entry, worth))
                 : NULL;
}

/* --- a mesh cache under the lock, mesh_cache.c ------------------------------------------------ */

/* The entry of that key, which may reach less far; */
struct server_entry *server_mesh_cache_find(const struct server_mesh_cache *fields,
                                            const struct server_field_key *key);

/* that reaches as far at least. */
struct server_entry *server_mesh_cache_find_covering(const struct server_mesh_cache *fields,
                                                     const struct server_field_key *key);

/* Puts an entry (NULL: there is none) on its mesh cache and in the order of eviction, with one more
 * reference for it, unless the mesh cache is closed or has one of that key that reaches as far, or
 * there is no memory. Returns the entry whose place and uses it took, for the caller to release
 * after the lock; or NULL. */
GD_MUST_USE struct server_entry *server_mesh_cache_put(struct server_entry *entry);

/* Takes an entry off its mesh cache and out of the order; the mesh cache's reference is the
 * caller's to release after the lock. */
void server_mesh_cache_withdraw(struct server_entry *entry);

/* Takes an entry that left the order off its mesh cache; the mesh cache's reference is the caller's
 * to release after the lock. */
void server_mesh_cache_remove(struct server_entry *entry);

#endif
