/* See registry.h and store.h.
 *
 * DESIGN. An array sorted by name under a reader-writer lock: names are listed in order, found in O(log n), and
 * change seldom. Surfaces are retired and released after the lock is given up, since that frees fields. */
#include "server/registry.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct registry {
    struct server_store store; /* first */
    pthread_rwlock_t lock;
    struct server_surface **surfaces; /* sorted by name */
    uint32_t count, capacity;
};

/* Index of the first surface whose name is not before `name`. */
static uint32_t lower_bound(const struct registry *registry, const char *name)
{
    uint32_t low = 0, high = registry->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(registry->surfaces[middle]->origin.name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool is_at(const struct registry *registry, uint32_t index, const char *name)
{
    return index < registry->count && strcmp(registry->surfaces[index]->origin.name, name) == 0;
}

static bool reserve(struct registry *registry)
{
    if (registry->count < registry->capacity) return true;
    uint32_t capacity = registry->capacity ? 2 * registry->capacity : 16;
    struct server_surface **surfaces = realloc(registry->surfaces, capacity * sizeof *surfaces);
    if (!surfaces) return false;
    registry->surfaces = surfaces;
    registry->capacity = capacity;
    return true;
}

static void retire(struct server_surface *surface)
{
    if (!surface) return;
    server_surface_retire(surface);
    server_surface_release(surface);
}

/* Under the lock. What was there before goes to `*before`. */
static enum server_store_outcome insert(struct registry *registry, struct server_surface *surface,
                                        const struct server_precondition *precondition, struct server_surface **before)
{
    uint32_t at = lower_bound(registry, surface->origin.name);
    bool exists = is_at(registry, at, surface->origin.name);
    if (!server_precondition_holds(precondition, exists ? registry->surfaces[at]->etag : NULL))
        return SERVER_STORE_PRECONDITION;
    if (exists) {
        *before = registry->surfaces[at];
    } else {
        if (!reserve(registry)) return SERVER_STORE_NO_MEMORY;
        memmove(&registry->surfaces[at + 1], &registry->surfaces[at],
                (registry->count - at) * sizeof *registry->surfaces);
        registry->count++;
    }
    registry->surfaces[at] = server_surface_retain(surface);
    return exists ? SERVER_STORE_REPLACED : SERVER_STORE_CREATED;
}

static enum server_store_outcome registry_put(struct server_store *store, struct server_surface *surface,
                                              const void *bytes, size_t size,
                                              const struct server_precondition *precondition)
{
    struct registry *registry = (struct registry *)store;
    struct server_surface *before = NULL;
    (void)bytes, (void)size; /* only a durable store keeps them */
    pthread_rwlock_wrlock(&registry->lock);
    enum server_store_outcome outcome = insert(registry, surface, precondition, &before);
    pthread_rwlock_unlock(&registry->lock);
    retire(before);
    return outcome;
}

/* Under the lock. */
static enum server_store_outcome extract(struct registry *registry, const char *name,
                                         const struct server_precondition *precondition,
                                         struct server_surface **removed)
{
    uint32_t at = lower_bound(registry, name);
    if (!is_at(registry, at, name)) return SERVER_STORE_ABSENT;
    if (!server_precondition_holds(precondition, registry->surfaces[at]->etag)) return SERVER_STORE_PRECONDITION;
    *removed = registry->surfaces[at];
    registry->count--;
    memmove(&registry->surfaces[at], &registry->surfaces[at + 1], (registry->count - at) * sizeof *registry->surfaces);
    return SERVER_STORE_REMOVED;
}

static enum server_store_outcome registry_remove(struct server_store *store, const char *name,
                                                 const struct server_precondition *precondition)
{
    struct registry *registry = (struct registry *)store;
    struct server_surface *removed = NULL;
    pthread_rwlock_wrlock(&registry->lock);
    enum server_store_outcome outcome = extract(registry, name, precondition, &removed);
    pthread_rwlock_unlock(&registry->lock);
    retire(removed);
    return outcome;
}

static struct server_surface *registry_get(struct server_store *store, const char *name)
{
    struct registry *registry = (struct registry *)store;
    pthread_rwlock_rdlock(&registry->lock);
    uint32_t at = lower_bound(registry, name);
    struct server_surface *surface = is_at(registry, at, name) ? server_surface_retain(registry->surfaces[at]) : NULL;
    pthread_rwlock_unlock(&registry->lock);
    return surface;
}

static uint32_t registry_list(struct server_store *store, const char *after, uint32_t most, struct server_surface **out)
{
    struct registry *registry = (struct registry *)store;
    uint32_t listed = 0;
    pthread_rwlock_rdlock(&registry->lock);
    uint32_t at = after ? lower_bound(registry, after) : 0;
    if (after && is_at(registry, at, after)) at++;
    for (; listed < most && at < registry->count; at++) out[listed++] = server_surface_retain(registry->surfaces[at]);
    pthread_rwlock_unlock(&registry->lock);
    return listed;
}

static uint32_t registry_count(struct server_store *store)
{
    struct registry *registry = (struct registry *)store;
    pthread_rwlock_rdlock(&registry->lock);
    uint32_t count = registry->count;
    pthread_rwlock_unlock(&registry->lock);
    return count;
}

static void registry_close(struct server_store *store)
{
    struct registry *registry = (struct registry *)store;
    for (uint32_t i = 0; i < registry->count; i++) retire(registry->surfaces[i]);
    pthread_rwlock_destroy(&registry->lock);
    free(registry->surfaces);
    free(registry);
}

struct server_store *server_registry_create(void)
{
    struct registry *registry = calloc(1, sizeof *registry);
    if (!registry) return NULL;
    registry->store = (struct server_store){.put = registry_put,
                                            .get = registry_get,
                                            .remove = registry_remove,
                                            .list = registry_list,
                                            .count = registry_count,
                                            .close = registry_close};
    pthread_rwlock_init(&registry->lock, NULL);
    return &registry->store;
}
