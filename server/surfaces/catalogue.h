/* Catalogue: the field resources of a mesh, which clients name by id. Each resource stores the
 * request of its field, so that an evicted field can be built again.
 *
 * DESIGN. A catalogue is attached to the record of a mesh: it survives unloading, and is destroyed
 * when the mesh is replaced or deleted. The resources of one API key are limited in number and
 * bytes; beyond that, the least recently used one of the key is forgotten. The ids of forgotten
 * resources are kept for a while, so that the answer to their clients gives the reason. Resources
 * are reference-counted and immutable. One mutex guards the list. All functions are thread-safe. */
#ifndef SERVER_SURFACES_CATALOGUE_H
#define SERVER_SURFACES_CATALOGUE_H

#include <stdatomic.h>

#include "proto/queries/field.h"
#include "proto/values/set.h"
#include "server/access/credentials.h"
#include "server/store/record.h"
#include "server/work/budget.h"

#define SERVER_CATALOGUE_RESOURCES 1024 /* most resources of a key */
#define SERVER_CATALOGUE_BYTES     ((size_t)16 << 20)
#define SERVER_CATALOGUE_FORGOTTEN 256

struct server_resource {
    atomic_uint references;
    char id[PROTO_FIELD_ID + 1];
    char key[SERVER_CREDENTIAL_NAME]; /* key of its creator; "": the daemon has no keys */
    struct proto_located_set *set;
    struct proto_field_description description; /* `id` is the one above */
    struct server_budget *budget;
    size_t bytes;               /* bytes taken of SERVER_BUDGET_FIELDS */
    char *set_text;             /* see the description; owned */
    uint64_t turn;              /* catalogue's clock at the last use; under its lock */
    atomic_uint_least64_t uses; /* how often it was found */
};

/* Creates a resource with one reference. Takes over the set; copies the description, with an id of
 * its own and a copy of its set. NULL: no memory in the budget or the system; then the caller still
 * owns the set. */
struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget);
void server_resource_release(struct server_resource *resource); /* NULL is allowed */

/* Returns the request that the field answers, borrowed from the resource. */
struct gd_field_request server_resource_request(const struct server_resource *resource);

/* Writes the id of a field: of this set, on the mesh of that ETag. Returns false if out of
 * memory. */
bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1]);

struct server_catalogue;

/* Creates an empty catalogue that is not attached to a record. Returns NULL if out of memory. */
struct server_catalogue *server_catalogue_create(void);
void server_catalogue_destroy(struct server_catalogue *catalogue); /* NULL is allowed */

/* Returns the catalogue of a record, its owner; the first call creates it. Returns NULL if out of
 * memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

enum server_catalogue_finding {
    SERVER_CATALOGUE_FOUND, /* `*out` is retained, and counted as used */
    SERVER_CATALOGUE_ABSENT,
    SERVER_CATALOGUE_FORGOT /* there was a resource with that id */
};

/* Finds a resource by an id that is not empty. */
enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out);

/* Adds a resource of a key ("": there are no keys) and returns true. If its id exists already,
 * releases it, sets `*resource` to the existing one, retained, and returns false. */
bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource);

/* Removes the resource of that id and returns it, retained; NULL: there is none. */
struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id);

/* Lists up to `most` resources with ids after `after` (or NULL), in order, each retained. */
uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out);

#endif
