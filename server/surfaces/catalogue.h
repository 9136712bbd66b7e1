/* Catalogue: the fields of a mesh that clients know by id, each with the request that it answers,
 * so that a field whose wedges were evicted can be built again.
 *
 * DESIGN. A catalogue is attached to the record of a mesh: unloading the mesh keeps it, replacing
 * or deleting the mesh ends it. The fields that one API key listed are bounded in number and bytes:
 * the least recently used of that key is forgotten. Its id is remembered for a while, so that a
 * client that asks for it learns why it is gone. Resources are counted and immutable. One mutex
 * guards the list. All functions are thread-safe. */
#ifndef SERVER_SURFACES_CATALOGUE_H
#define SERVER_SURFACES_CATALOGUE_H

#include <stdatomic.h>

#include "proto/queries/field.h"
#include "proto/values/set.h"
#include "server/access/credentials.h"
#include "server/store/record.h"
#include "server/work/budget.h"

#define SERVER_CATALOGUE_RESOURCES 1024 /* of a key */
#define SERVER_CATALOGUE_BYTES     ((size_t)16 << 20)
#define SERVER_CATALOGUE_FORGOTTEN 256

struct server_resource {
    atomic_uint references;
    char id[PROTO_FIELD_ID + 1];
    char key[SERVER_CREDENTIAL_NAME]; /* that listed it; "": the daemon has no keys */
    struct proto_located_set *set;
    struct proto_field_description description; /* `id` is the one above */
    struct server_budget *budget;
    size_t bytes;               /* of SERVER_BUDGET_FIELDS */
    char *set_text;             /* see the description; owned */
    uint64_t turn;              /* of the catalogue's clock at the last use; under its lock */
    atomic_uint_least64_t uses; /* how often it was found */
};

/* A field as a resource with one reference. Takes over the set (free()); the description's id is
 * replaced, its set copied. NULL without memory, of budget or system: the set stays the caller's. */
struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget);
void server_resource_release(struct server_resource *resource); /* NULL is harmless */

/* The request that the field answers; borrowed from the resource. */
struct gd_field_request server_resource_request(const struct server_resource *resource);

/* Writes the id of the field of this set on the mesh of that ETag. False without memory. */
bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1]);

struct server_catalogue;

/* An empty catalogue that is attached to no record; NULL without memory. */
struct server_catalogue *server_catalogue_create(void);
void server_catalogue_destroy(struct server_catalogue *catalogue); /* NULL is harmless */

/* The catalogue of a record, created on the first call; the record's. NULL without memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

enum server_catalogue_finding {
    SERVER_CATALOGUE_FOUND, /* `*out` is retained, and counted as used */
    SERVER_CATALOGUE_ABSENT,
    SERVER_CATALOGUE_FORGOT /* there was one of that id */
};

/* Finds a resource by an id that is not empty. */
enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out);

/* Lists a resource for a key ("": there are none) and returns true. If its id is listed already,
 * releases it, sets `*resource` to the listed one, retained, and returns false. */
bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource);

/* Removes the resource of that id, retained for the caller; NULL: there is none. */
struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id);

/* Up to `most` with ids after `after` (NULL: from the first), in order, each retained; returns how
 * many. */
uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out);

#endif
