/* Surface: a mesh with its name, origin and fields; what a name of the store stands for.
 *
 * Immutable but for its count and its shelf. The shelf holds fields, which hold the mesh: retiring the surface
 * closes it. */
#ifndef SERVER_SURFACE_H
#define SERVER_SURFACE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "gd/mesh.h"
#include "proto/mesh.h"
#include "server/cache.h"
#include "server/sha256.h"

#define SERVER_ETAG 33 /* with the NUL */

/* What a surface is made from. */
struct server_surface_origin {
    char name[PROTO_MESH_NAME + 1];
    char sha256[SERVER_SHA256_HEX]; /* of the uploaded bytes */
    struct proto_mesh_options options;
};

struct server_surface {
    atomic_uint references;
    struct server_surface_origin origin;
    char etag[SERVER_ETAG]; /* without quotes: of the bytes and the options */
    int64_t created;        /* seconds since 1970 */
    struct gd_mesh *mesh;
    size_t bytes; /* of the mesh, in SERVER_BUDGET_MESHES until the last reference goes */
    struct server_budget *budget;
    struct server_shelf *shelf;
};

/* Takes over the mesh and `bytes` of SERVER_BUDGET_FLIGHT, which become SERVER_BUDGET_MESHES. Budget and cache are
 * borrowed and outlive the surface. NULL without memory: mesh and bytes are the caller's still. The caller has one
 * reference. */
struct server_surface *server_surface_create(const struct server_surface_origin *origin, struct gd_mesh *mesh,
                                             size_t bytes, struct server_budget *budget, struct server_cache *cache);

struct server_surface *server_surface_retain(struct server_surface *surface);
void server_surface_release(struct server_surface *surface); /* NULL is harmless */

/* Ends the surface's fields; to be called once, when it leaves the store. */
void server_surface_retire(struct server_surface *surface);

/* Are they made from the same bytes with the same options? */
bool server_surface_origin_equal(const struct server_surface_origin *a, const struct server_surface_origin *b);

/* Entity tag of what that origin makes. */
void server_surface_etag(const struct server_surface_origin *origin, char etag[SERVER_ETAG]);

#endif
