/* See catalogue.h. */
#include "server/surfaces/catalogue.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/writer.h"
#include "server/base/sha256.h"

#define FIRST_CAPACITY     8
#define VERSION_CHARACTERS 8 /* an id begins with so many of the ETag */

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

static struct server_resource *resource_retain(struct server_resource *resource)
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

static void text_append_point(struct proto_writer *text, const struct gd_point *point)
{
    const uint32_t place[] = {(uint32_t)point->kind, point->element};
    proto_append(text, (const char *)place, sizeof place);
    proto_append(text, (const char *)point->weight, sizeof point->weight);
}

/* Member by member, without the padding. */
static void text_append_seed(struct proto_writer *text, const struct gd_seed *seed)
{
    text_append_point(text, &seed->point);
    proto_append(text, (const char *)&seed->offset, sizeof seed->offset);
    proto_append(text, seed->is_segment ? "s" : "p", 1);
    if (seed->is_segment) text_append_point(text, &seed->end);
}

bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1])
{
    struct proto_writer text; /* all that distinguishes sets */
    char hash[SERVER_SHA256_HEX];
    proto_writer_init(&text, SIZE_MAX);
    proto_append(&text, etag, strlen(etag));
    proto_append(&text, (const char *)&max_distance, sizeof max_distance);
    for (uint32_t i = 0; i < set->seed_count; i++) text_append_seed(&text, &set->seeds[i]);
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

/* Index of the first resource whose id is not before `id`; `*found`: it has this id. */
static uint32_t catalogue_search(const struct server_catalogue *catalogue, const char *id,
                                 bool *found)
{
    uint32_t low = 0, high = catalogue->count;
    *found = false;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        int order = strcmp(catalogue->resources[middle]->id, id);
        *found |= order == 0;
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static struct server_resource *catalogue_extract(struct server_catalogue *catalogue, uint32_t at)
{
    struct server_resource **place = &catalogue->resources[at], *resource = *place;
    memmove(place, place + 1, (--catalogue->count - at) * sizeof *place);
    return resource;
}

/* A place of that id in the ring of forgotten ids; or NULL. */
static char *find_forgotten(struct server_catalogue *catalogue, const char *id)
{
    for (uint32_t i = 0; i < SERVER_CATALOGUE_FORGOTTEN; i++)
        if (strcmp(catalogue->forgotten[i], id) == 0) return catalogue->forgotten[i];
    return NULL;
}

static void resource_forget(struct server_catalogue *catalogue, uint32_t at)
{
    struct server_resource *resource = catalogue_extract(catalogue, at);
    uint32_t place = catalogue->next_forgotten++ % SERVER_CATALOGUE_FORGOTTEN;
    memcpy(catalogue->forgotten[place], resource->id, sizeof resource->id);
    server_resource_release(resource);
}

struct usage {              /* of a key */
    uint32_t count, oldest; /* oldest: index of the resource that was not used for longest */
    size_t bytes;
};

/* What a key (NULL: all keys) has listed. */
static struct usage usage_of(const struct server_catalogue *catalogue, const char *key)
{
    struct usage usage = {0};
    for (uint32_t i = 0; i < catalogue->count; i++) {
        const struct server_resource *resource = catalogue->resources[i];
        if (key && strcmp(resource->key, key) != 0) continue;
        if (!usage.count++ || resource->turn < catalogue->resources[usage.oldest]->turn)
            usage.oldest = i;
        usage.bytes += resource->bytes;
    }
    return usage;
}

/* Makes room for one more; without memory, by forgetting one. */
static void catalogue_reserve(struct server_catalogue *catalogue)
{
    if (catalogue->count < catalogue->capacity) return;
    uint32_t capacity = 2 * catalogue->capacity;
    struct server_resource **more = realloc(catalogue->resources, capacity * sizeof *more);
    if (!more) {
        resource_forget(catalogue, usage_of(catalogue, NULL).oldest);
        return;
    }
    catalogue->resources = more;
    catalogue->capacity = capacity;
}

static void catalogue_insert(struct server_catalogue *catalogue, struct server_resource *resource)
{
    bool found;
    char *forgotten = find_forgotten(catalogue, resource->id);
    if (forgotten) forgotten[0] = '\0';
    catalogue_reserve(catalogue);
    uint32_t at = catalogue_search(catalogue, resource->id, &found);
    struct server_resource **place = &catalogue->resources[at];
    memmove(place + 1, place, (catalogue->count++ - at) * sizeof *place);
    *place = resource_retain(resource);
    resource->turn = ++catalogue->clock;
    struct usage usage;
    while ((usage = usage_of(catalogue, resource->key)).count > SERVER_CATALOGUE_RESOURCES ||
           usage.bytes > SERVER_CATALOGUE_BYTES)
        resource_forget(catalogue, usage.oldest);
}

/* --- life ------------------------------------------------------------------------------------- */

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

/* --- in and out ------------------------------------------------------------------------------- */

enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out)
{
    bool found;
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = catalogue_search(catalogue, id, &found);
    bool is_forgotten = !found && find_forgotten(catalogue, id);
    if (found) {
        *out = resource_retain(catalogue->resources[at]);
        (*out)->turn = ++catalogue->clock;
    }
    pthread_mutex_unlock(&catalogue->lock);
    return found          ? SERVER_CATALOGUE_FOUND
           : is_forgotten ? SERVER_CATALOGUE_FORGOT
                          : SERVER_CATALOGUE_ABSENT;
}

bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource)
{
    struct server_resource *added = *resource;
    bool found;
    snprintf(added->key, sizeof added->key, "%s", key);
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = catalogue_search(catalogue, added->id, &found);
    if (found)
        *resource = resource_retain(catalogue->resources[at]);
    else
        catalogue_insert(catalogue, added);
    pthread_mutex_unlock(&catalogue->lock);
    if (found) server_resource_release(added);
    return !found;
}

struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id)
{
    bool found;
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = catalogue_search(catalogue, id, &found);
    struct server_resource *removed = found ? catalogue_extract(catalogue, at) : NULL;
    pthread_mutex_unlock(&catalogue->lock);
    return removed;
}

uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out)
{
    uint32_t count = 0;
    bool found;
    pthread_mutex_lock(&catalogue->lock);
    uint32_t at = catalogue_search(catalogue, after ? after : "", &found);
    if (found) at++;
    while (count < most && at < catalogue->count)
        out[count++] = resource_retain(catalogue->resources[at++]);
    pthread_mutex_unlock(&catalogue->lock);
    return count;
}
