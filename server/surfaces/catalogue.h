/* Catalogue: the fields of a mesh that clients know by an id, each with the request that it is the
 * field of: so that one whose wedges were evicted can be built again.
 *
 * DESIGN. A catalogue belongs to a version of a mesh, that is to its record: unloading the mesh
 * and loading it again leaves it as it is, replacing or deleting the mesh ends it. What each key
 * lists is bounded in number and bytes: its resource that was not used for longest is forgotten,
 * never another key's, and its id is kept for a while, so that a client that asks for it can be
 * told. Resources are counted and immutable. One mutex guards the list. Thread-safe. */
#ifndef SERVER_SURFACES_CATALOGUE_H
#define SERVER_SURFACES_CATALOGUE_H

#include <stdatomic.h>

#include "proto/field.h"
#include "server/work/budget.h"
#include "server/access/credentials.h"
#include "server/store/record.h"

#define SERVER_CATALOGUE_RESOURCES 1024 /* of a key */
#define SERVER_CATALOGUE_BYTES     ((size_t)16 << 20)
#define SERVER_CATALOGUE_FORGOTTEN 256
struct server_resource {
    atomic_uint references;
    char id[PROTO_FIELD_ID + 1];
    char key[SERVER_CREDENTIAL_NAME]; /* that listed it; "": the daemon has none */
    struct proto_located_set *set;
    struct proto_field_description description; /* `id` is the one above */
    struct server_budget *budget;
    size_t bytes;  /* of SERVER_BUDGET_FIELDS */
    uint64_t turn; /* of the catalogue's clock, when it was used last; under its lock */
};

/* A field as a resource, with one reference, the caller's. Takes over the set (free()); the
 * description's id is the resource's own. NULL without memory, in the budget or in the system: the
 * set is the caller's still. */
struct server_resource *server_resource_create(const char *id, struct proto_located_set *set,
                                               const struct proto_field_description *description,
                                               struct server_budget *budget);
void server_resource_release(struct server_resource *resource); /* NULL is harmless */

/* What it is the field of; borrowed from the resource. */
struct gd_field_request server_resource_request(const struct server_resource *resource);

/* Writes the id of the field of this set on the mesh of that ETag. False without memory. */
bool server_resource_name(const char *etag, const struct proto_located_set *set,
                          double max_distance, char id[PROTO_FIELD_ID + 1]);

struct server_catalogue;

/* An empty catalogue, which is attached to no record; NULL without memory. */
struct server_catalogue *server_catalogue_create(void);
void server_catalogue_destroy(struct server_catalogue *catalogue); /* NULL is harmless */

/* The catalogue of a record, created on the first call; the record's. NULL without memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

enum server_catalogue_finding {
    SERVER_CATALOGUE_FOUND,
    SERVER_CATALOGUE_ABSENT,
    SERVER_CATALOGUE_FORGOT
};

/* FOUND: the resource, retained and counted as used. FORGOT: there was one of that id. `id` is not
 * empty. */
enum server_catalogue_finding server_catalogue_find(struct server_catalogue *catalogue,
                                                    const char *id, struct server_resource **out);

/* Lists a resource for a key ("": there are none), which stays retained for the caller, unless
 * one of its id is listed: then its reference goes, and `*resource` becomes the other one,
 * retained. True if it was listed. */
bool server_catalogue_add(struct server_catalogue *catalogue, const char *key,
                          struct server_resource **resource);

/* Takes the resource of that id from the list, retained for the caller; NULL: there is none. */
struct server_resource *server_catalogue_remove(struct server_catalogue *catalogue, const char *id);

/* Up to `most` with ids after `after` (NULL: from the first), in order, each retained; returns how
 * many. */
uint32_t server_catalogue_list(struct server_catalogue *catalogue, const char *after, uint32_t most,
                               struct server_resource **out);

#endif
