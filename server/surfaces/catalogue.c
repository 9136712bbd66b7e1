#include "server/surfaces/catalogue.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/writer.h"
#include "server/base/sha256.h"
#include "server/base/sorted.h"
#include "server/base/thread.h"

#define VERSION_CHARACTERS 8 /* number of characters of the ETag at the beginning of an id */

#define MEMSIZE                                                                                    \
    ((SERVER_CATALOGUE_RESOURCES + 1) * sizeof(void *) + sizeof(struct server_catalogue))

struct server_catalogue {
    struct server_attached attached; /* must be the first member; attached to a record */
    pthread_mutex_t lock;
    struct server_sorted resources; /* by id */
    uint64_t clock;
    /* a ring of ids; "" is an unused entry */
    char forgotten[SERVER_CATALOGUE_FORGOTTEN][PROTO_FIELD_ID + 1];
    uint32_t next_forgotten;
};

/* --- resources -------------------------------------------------------------------------------- */

struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget)
{
    size_t text_size = description->set ? strlen(description->set) + 1 : 0,
           bytes = sizeof(struct server_resource) + set->bytes + text_size;
    struct server_resource *resource = malloc(sizeof *resource);
    char *text = text_size ? strdup(description->set) : NULL;
    if (!resource || (text_size && !text) ||
        !server_budget_take(budget, SERVER_BUDGET_FIELDS, bytes)) {
        free(text);
        free(resource);
        return NULL;
    }
    *resource = (struct server_resource){.references = 1,
                                         .set = set,
                                         .set_text = text,
                                         .description = *description,
                                         .budget = budget,
                                         .bytes = bytes};
    resource->description.set = text;
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
    free(resource->set_text);
    free(resource->set);
    free(resource);
}

struct gd_field_request server_resource_request(const struct server_resource *resource)
{
    return (struct gd_field_request){.seeds = resource->set->seeds,
                                     .seed_count = resource->set->seed_count,
                                     .radius = resource->description.max_distance};
}

/* Appends the members of the seed one by one, because the padding of structs is undefined. */
static void text_append_seed(struct proto_writer *text, const struct gd_seed *seed)
{
    proto_append(text, (const char *)&seed->point, sizeof seed->point);
    proto_append(text, (const char *)&seed->offset, sizeof seed->offset);
    proto_append(text, seed->is_segment ? "s" : "p", 1);
    if (seed->is_segment) proto_append(text, (const char *)&seed->end, sizeof seed->end);
}

bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1])
{
    struct proto_writer text; /* contains all data that distinguishes sets */
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

static int resource_compare(const void *resource, const void *id)
{
    return strcmp(((const struct server_resource *)resource)->id, id);
}

/* Returns the entry of that id in the ring of forgotten ids, or NULL. */
static char *forgotten_find(struct server_catalogue *catalogue, const char *id)
{
    for (uint32_t i = 0; i < SERVER_CATALOGUE_FORGOTTEN; i++)
        if (strcmp(catalogue->forgotten[i], id) == 0) return catalogue->forgotten[i];
    return NULL;
}

static void resource_forget(struct server_catalogue *catalogue, uint32_t at)
{
    struct server_resource *resource = server_sorted_remove(&catalogue->resources, at);
    uint32_t place = catalogue->next_forgotten++ % SERVER_CATALOGUE_FORGOTTEN;
    memcpy(catalogue->forgotten[place], resource->id, sizeof resource->id);
    server_resource_release(resource);
}

struct usage {              /* The resources of a key. */
    uint32_t count, oldest; /* `oldest` is the index of the least recently used one */
    size_t bytes;
};

/* Returns the usage of a key, or of all keys if `key` is NULL. */
static struct usage key_usage(const struct server_catalogue *catalogue, const char *key)
{
    struct usage usage = {0};
    uint64_t oldest = 0;
    for (uint32_t i = 0; i < catalogue->resources.count; i++) {
        const struct server_resource *resource = catalogue->resources.items[i];
        if (key && strcmp(resource->key, key) != 0) continue;
        usage.bytes += resource->bytes;
        if (usage.count++ && resource->turn >= oldest) continue;
        oldest = resource->turn;
        usage.oldest = i;
    }
    return usage;
}

/* Inserts a resource. Forgets another resource if memory is short. */
static void catalogue_insert(struct server_catalogue *catalogue, struct server_resource *resource)
{
    struct server_sorted *resources = &catalogue->resources;
    struct usage usage;
    char *forgotten = forgotten_find(catalogue, resource->id);
    if (forgotten) forgotten[0] = '\0';
    if (!server_sorted_reserve(resources))
        resource_forget(catalogue, key_usage(catalogue, NULL).oldest);
    server_sorted_insert(resources, server_sorted_index(resources, resource->id),
                         resource_retain(resource));
    resource->turn = ++catalogue->clock;
    while ((usage = key_usage(catalogue, resource->key)).count > SERVER_CATALOGUE_RESOURCES ||
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
    catalogue->resources.compare = resource_compare;
    pthread_mutex_init(&catalogue->lock, NULL);
    if (server_sorted_reserve(&catalogue->resources)) return catalogue;
    server_catalogue_destroy(catalogue);
    return NULL;
}

void server_catalogue_destroy(struct server_catalogue *catalogue)
{
    if (!catalogue) return;
    for (uint32_t i = 0; i < catalogue->resources.count; i++)
        server_resource_release(catalogue->resources.items[i]);
    pthread_mutex_destroy(&catalogue->lock);
    free(catalogue->resources.items);
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
    SERVER_LOCK(&catalogue->lock);
    struct server_resource *found = server_sorted_find(&catalogue->resources, id);
    if (!found)
        return forgotten_find(catalogue, id) ? SERVER_CATALOGUE_FORGOT : SERVER_CATALOGUE_ABSENT;
    *out = resource_retain(found);
    found->turn = ++catalogue->clock;
    atomic_fetch_add(&found->uses, 1);
    return SERVER_CATALOGUE_FOUND;
}

bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource)
{
    struct server_resource *added = *resource;
    snprintf(added->key, sizeof added->key, "%s", key);
    pthread_mutex_lock(&catalogue->lock);
    struct server_resource *found = server_sorted_find(&catalogue->resources, added->id);
    if (found)
        *resource = resource_retain(found);
    else
        catalogue_insert(catalogue, added);
    pthread_mutex_unlock(&catalogue->lock);
    if (found) server_resource_release(added);
    return !found;
}

struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id)
{
    struct server_sorted *resources = &catalogue->resources;
    SERVER_LOCK(&catalogue->lock);
    struct server_resource *removed = server_sorted_find(resources, id);
    if (removed) server_sorted_remove(resources, server_sorted_index(resources, id));
    return removed;
}

uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out)
{
    const struct server_sorted *resources = &catalogue->resources;
    uint32_t count = 0;
    SERVER_LOCK(&catalogue->lock);
    uint32_t at = server_sorted_after(resources, after ? after : "");
    while (count < most && at < resources->count)
        out[count++] = resource_retain(resources->items[at++]);
    return count;
}
