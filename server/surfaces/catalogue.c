/* See catalogue.h. */
#include "server/surfaces/catalogue.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/writer.h"
#include "server/base/sha256.h"

#define FIRST_CAPACITY     8
#define VERSION_CHARACTERS 8 /* of an id that are the ETag's */

#define MEMSIZE                                                                                    \
    ((SERVER_CATALOGUE_RESOURCES + 1) * sizeof(void *) + sizeof(struct server_catalogue))

struct server_catalogue {
    struct server_attached attached; /* first; to a record */
    pthread_mutex_t lock;
    struct server_resource **resources; /* sorted by id */
    uint32_t count, capacity;
    uint64_t clock;
    char forgotten[SERVER_CATALOGUE_FORGOTTEN][PROTO_FIELD_ID + 1]; /* a ring; empty: none */
    uint32_t next_forgotten;
};

/* --- resources -------------------------------------------------------------------------------- */

struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget)
{
    size_t bytes = sizeof(struct server_resource) + set->bytes;
    struct server_resource *resource = malloc(sizeof *resource);
    if (!resource || !server_budget_take(budget, SERVER_BUDGET_FIELDS, bytes)) {
        free(resource);
        return NULL;
    }
    *resource = (struct server_resource){
        .references = 1, .set = set, .description = *description, .budget = budget, .bytes = bytes};
    snprintf(resource->id, sizeof resource->id, "%s", id);
    resource->description.id = resource->id;
    return resource;
}

static struct server_resource *retain(struct server_resource *resource)
{
    atomic_fetch_add(&resource->references, 1);
    return resource;
}

void server_resource_release(struct server_resource *resource)
{
    if (!resource || atomic_fetch_sub(&resource->references, 1) != 1) return;
    server_budget_give(resource->budget, SERVER_BUDGET_FIELDS, resource->bytes);
    free(resource->set);
    free(resource);
}

struct gd_field_request server_resource_request(const struct server_resource *resource)
{
    return (struct gd_field_request){.seeds = resource->set->seeds,
                                     .seed_count = resource->set->seed_count,
                                     .radius = resource->description.max_distance};
}

static void append_point(struct proto_writer *text, const struct gd_point *point)
{
    const uint32_t place[] = {(uint32_t)point->kind, point->element};
    proto_append(text, (const char *)place, sizeof place);
    proto_append(text, (const char *)point->weight, sizeof point->weight);
}

/* Member by member: what lies between them is nobody's. */
static void append_seed(struct proto_writer *text, const struct gd_seed *seed)
{
    append_point(text, &seed->point);
    proto_append(text, (const char *)&seed->offset, sizeof seed->offset);
    proto_append(text, seed->is_segment ? "s" : "p", 1);
    if (seed->is_segment) append_point(text, &seed->end);
}

bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1])
{
    struct proto_writer text; /* whatever tells sets apart */
    char hash[SERVER_SHA256_HEX];
    proto_writer_init(&text, SIZE_MAX);
    proto_append(&text, etag, strlen(etag));
    proto_append(&text, (const char *)&max_distance, sizeof max_distance);
    for (uint32_t i = 0; i < set->seed_count; i++) append_seed(&text, &set->seeds[i]);
    proto_append(&text, (const char *)set->members, set->seed_count * sizeof *set->members);
    proto_append(&text, (const char *)set->label_offsets, set->count * sizeof *set->label_offsets);
    proto_append(&text, set->labels, set->label_size);
    bool ok = text.failure == PROTO_WRITER_FINE;
    if (ok) {
        server_sha256(text.data, text.size, hash);
        snprintf(id, PROTO_FIELD_ID + 1, "%.*s%.*s", VERSION_CHARACTERS, etag,
                 PROTO_FIELD_ID - VERSION_CHARACTERS, hash);
    }
    proto_writer_free(&text);
    return ok;
}

/* --- the list, under the lock ----------------------------------------------------------------- */

/* Index of the first resource whose id is not before `id`. */
static uint32_t lower_bound(const struct server_catalogue *catalogue, const char *id)
{
    uint32_t low = 0, high = catalogue->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(catalogue->resources[middle]->id, id) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool is_at(const struct server_catalogue *catalogue, uint32_t at, const char *id)
{
    return at < catalogue->count && strcmp(catalogue->resources[at]->id, id) == 0;
}

static struct server_resource *extract(struct server_catalogue *catalogue, uint32_t at)
{
    struct server_resource *resource = catalogue->resources[at];
    catalogue->count--;
    memmove(&catalogue->resources[at], &catalogue->resources[at + 1],
            (catalogue->count - at) * sizeof(struct server_resource *));
    return resource;
}

static void insert(struct server_catalogue *catalogue, uint32_t at,
                   struct server_resource *resource)
{
    memmove(&catalogue->resources[at + 1], &catalogue->resources[at],
            (catalogue->count - at) * sizeof(struct server_resource *));
    catalogue->resources[at] = resource;
    catalogue->count++;
    resource->turn = ++catalogue->clock;
}

static char *find_forgotten(struct server_catalogue *catalogue, const char *id)
{
    for (uint32_t i = 0; i < SERVER_CATALOGUE_FORGOTTEN; i++)
        if (strcmp(catalogue->forgotten[i], id) == 0) return catalogue->forgotten[i];
    return NULL;
}

/* What a key (NULL: all) lists. */
struct listed {
    uint32_t count, oldest; /* oldest: the place of the resource that was not used for longest */
    size_t bytes;
};

static struct listed weigh(const struct server_catalogue *catalogue, const char *key)
{
    struct listed listed = {0};
    for (uint32_t i = 0; i < catalogue->count; i++) {
        const struct server_resource *resource = catalogue->resources[i];
        if (key && strcmp(resource->key, key) != 0) continue;
        if (!listed.count++ || resource->turn < catalogue->resources[listed.oldest]->turn)
            listed.oldest = i;
        listed.bytes += resource->bytes;
    }
    return listed;
}

static void forget(struct server_catalogue *catalogue, uint32_t at)
{
    struct server_resource *resource = extract(catalogue, at);
    uint32_t place = catalogue->next_forgotten++ % SERVER_CATALOGUE_FORGOTTEN;
    memcpy(catalogue->forgotten[place], resource->id, sizeof resource->id);
    server_resource_release(resource);
}

/* Forgets resources of the key until it has as many as it may. */
static void bound(struct server_catalogue *catalogue, const char *key)
{
    struct listed listed;
    while ((listed = weigh(catalogue, key)).count > SERVER_CATALOGUE_RESOURCES ||
           listed.bytes > SERVER_CATALOGUE_BYTES)
        forget(catalogue, listed.oldest);
}

/* Room for one more; without memory for it, that of one that was not used for longest. */
static void grow(struct server_catalogue *catalogue)
{
    if (catalogue->count < catalogue->capacity) return;
    uint32_t capacity = 2 * catalogue->capacity;
    struct server_resource **more =
        realloc(catalogue->resources, capacity * sizeof(struct server_resource *));
    if (!more) {
        forget(catalogue, weigh(catalogue, NULL).oldest);
        return;
    }
    catalogue->resources = more;
    catalogue->capacity = capacity;
}

/* --- in and out ------------------------------------------------------------------------------- */

static void catalogue_detach(struct server_attached *attached)
{
    server_catalogue_destroy((struct server_catalogue *)attached);
}

struct server_catalogue *server_catalogue_create(void)
{
    struct server_catalogue *catalogue = calloc(1, sizeof *catalogue);
    if (!catalogue) return NULL;
    catalogue->attached = (struct server_attached){.bytes = MEMSIZE, .destroy = catalogue_detach};
    catalogue->capacity = FIRST_CAPACITY;
    catalogue->resources = malloc(FIRST_CAPACITY * sizeof(struct server_resource *));
    pthread_mutex_init(&catalogue->lock, NULL);
    if (catalogue->resources) return catalogue;
    server_catalogue_destroy(catalogue);
    return NULL;
}

void server_catalogue_destroy(struct server_catalogue *catalogue)
{
    if (!catalogue) return;
    for (uint32_t i = 0; i < catalogue->count; i++)
        server_resource_release(catalogue->resources[i]);
    pthread_mutex_destroy(&catalogue->lock);
    free(catalogue->resources);
    free(catalogue);
}

struct server_catalogue *server_record_catalogue(struct server_record *record)
{
    struct server_attached *attached = atomic_load(&record->attached);
    struct server_catalogue *made = attached ? NULL : server_catalogue_create();
    if (made) attached = server_record_attach(record, &made->attached);
    return (struct server_catalogue *)attached;
}

enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out)
{
    enum server_catalogue_finding finding = SERVER_CATALOGUE_ABSENT;
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = lower_bound(catalogue, id);
    if (is_at(catalogue, at, id)) {
        *out = retain(catalogue->resources[at]);
        (*out)->turn = ++catalogue->clock;
        finding = SERVER_CATALOGUE_FOUND;
    } else if (find_forgotten(catalogue, id)) {
        finding = SERVER_CATALOGUE_FORGOT;
    }
    pthread_mutex_unlock(&catalogue->lock);
    return finding;
}

bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource)
{
    struct server_resource *added = *resource;
    snprintf(added->key, sizeof added->key, "%s", key);
    pthread_mutex_lock(&catalogue->lock);
    grow(catalogue);
    uint32_t at = lower_bound(catalogue, added->id);
    bool is_new = !is_at(catalogue, at, added->id);
    if (is_new) {
        char *forgotten = find_forgotten(catalogue, added->id);
        if (forgotten) forgotten[0] = '\0';
        insert(catalogue, at, retain(added));
        bound(catalogue, key);
    } else {
        *resource = retain(catalogue->resources[at]);
        server_resource_release(added);
    }
    pthread_mutex_unlock(&catalogue->lock);
    return is_new;
}

struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id)
{
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = lower_bound(catalogue, id);
    struct server_resource *removed = is_at(catalogue, at, id) ? extract(catalogue, at) : NULL;
    pthread_mutex_unlock(&catalogue->lock);
    return removed;
}

uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out)
{
    uint32_t count = 0;
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = after ? lower_bound(catalogue, after) : 0;
    if (after && is_at(catalogue, at, after)) at++;
    while (count < most && at < catalogue->count) out[count++] = retain(catalogue->resources[at++]);
    pthread_mutex_unlock(&catalogue->lock);
    return count;
}
