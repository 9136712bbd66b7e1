/* Catalogue: the field resources of a mesh, which clients name by id. Each resource stores the
 * request of its field, so that an evicted field can be built again.
 *
 * DESIGN. A catalogue is attached to the record of a mesh: it survives unloading, and is destroyed
 * when the mesh is replaced or deleted. The resources of one API key are limited in number and
 * bytes. Above the limit, the least recently used resource of the key is forgotten. The ids of
 * forgotten resources are kept for some time, so that the answers to their clients can give the
 * reason. Resources are reference-counted and immutable. One mutex guards the list. All functions
 * are thread-safe. */
#pragma once

#include <stdatomic.h>

#include "proto/queries/field.h"
#include "proto/values/set.h"
#include "server/access/credentials.h"
#include "server/store/record.h"
#include "server/work/budget.h"

#define SERVER_CATALOGUE_RESOURCES 1024 /* limit on the resources of a key */
#define SERVER_CATALOGUE_BYTES     ((size_t)16 << 20)
#define SERVER_CATALOGUE_FORGOTTEN 256

struct server_resource {
    atomic_uint references;
    char id[PROTO_FIELD_ID + 1];
    /* name of the key that created the resource, or "" if the daemon has no keys */
    char key[SERVER_CREDENTIAL_NAME];
    struct proto_located_set *set;
    struct proto_field_description description; /* its `id` is the member above */
    struct server_budget *budget;
    size_t bytes;   /* bytes taken from SERVER_BUDGET_FIELDS */
    char *set_text; /* see the description; owned */
    /* value of the catalogue's clock at the last use; guarded by the catalogue's lock */
    uint64_t turn;
    atomic_uint_least64_t uses; /* number of times that the resource was found */
};

/* Creates a resource with one reference. Takes over the set. Copies the description, including the
 * texts of its id and its set. Returns NULL if budget or system have no memory; the caller then
 * still owns the set. */
struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget);
void server_resource_release(struct server_resource *resource); /* NULL is allowed */

/* Returns the request that the field answers, borrowed from the resource. */
struct gd_field_request server_resource_request(const struct server_resource *resource);

/* Writes the id of the field of this set on the mesh with that ETag. Returns false if out of
 * memory. */
bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1]);

struct server_catalogue;

/* Creates an empty catalogue that is not attached to a record. Returns NULL if out of memory. */
struct server_catalogue *server_catalogue_create(void);
void server_catalogue_destroy(struct server_catalogue *catalogue); /* NULL is allowed */

/* Returns the catalogue of a record, which owns the catalogue. The first call creates it. Returns
 * NULL if out of memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

enum server_catalogue_finding {
    SERVER_CATALOGUE_FOUND, /* `*out` is retained, and a use is counted */
    SERVER_CATALOGUE_ABSENT,
    SERVER_CATALOGUE_FORGOT /* a resource with that id existed and was forgotten */
};

/* Finds a resource by an id that is not empty. */
enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out);

/* Adds a resource of a key ("" if there are no keys) and returns true. If the id already exists,
 * releases the resource, retains the existing one as `*resource`, and returns false. */
bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource);

/* Removes the resource of that id, and returns it with a reference for the caller, or NULL if there
 * is none. */
struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id);

/* Lists up to `most` resources with ids after `after` (NULL means all), in order. Each resource is
 * retained. */
uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out);
