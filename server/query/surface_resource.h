/* Surface resource: a surface as clients see it. These functions build a surface from a file's
 * bytes, describe it in an answer, and store meshes that the daemon makes. */
#pragma once

#include "gd/polygons.h"
#include "proto/json/writer.h"
#include "server/exchange/exchange.h"
#include "server/surfaces/registry.h"

struct server_surface_source {
    const void *bytes;          /* the file; borrowed */
    const struct gd_mesh *mesh; /* the mesh of the file, if it is built already; otherwise NULL */
    void *attachment;           /* malloc'ed and counted as SERVER_BUDGET_FLIGHT; may be NULL */
};

/* Builds the surface of a record from its file, and stores the description in the record. `part`
 * monitors the build as a part of the exchange's progress. The call owns the attachment, even when
 * it fails. On failure, returns NULL with the problem. */
struct server_surface *server_surface_resource_build(struct server_monitor *part,
                                                     struct server_record *record,
                                                     const struct server_surface_source *source,
                                                     struct proto_problem *problem);

/* Writes the description: the current one if the surface is in memory, otherwise that in the
 * record. */
void server_surface_resource_describe(struct proto_writer *writer,
                                      const struct server_listed *listed);

/* Replies with the description and its ETag. */
void server_surface_resource_reply(struct server_exchange *exchange, unsigned status,
                                   const struct server_listed *listed);

/* Replies to a request that stores a surface: 201 or 200 with Location, or the problem. */
void server_surface_resource_reply_stored(struct server_exchange *exchange,
                                          struct server_surface *surface,
                                          enum server_outcome outcome);

/* --- derived meshes --------------------------------------------------------------------------- */

/* Meshes that the daemon makes from another surface: the pieces of a cut, a tessellation, a
 * discretization. They are resources like uploaded meshes, and equally durable.
 *
 *     meshes.exchange = exchange;                                 a worker
 *     server_derived_meshes_add(&meshes, name, &source, …);       the worker, for each mesh
 *     return server_request_write(exchange, store);
 *     server_derived_meshes_store(&meshes);                       in `store`
 *     server_derived_meshes_free(&meshes);                        when the state is freed
 *
 * A derived mesh is stored as binary PLY with doubles, so no coordinate is rounded. Vertices and
 * triangles keep the order of the polygons. */

/* Bytes that the daemon stores with a mesh, in a format of the code that made the mesh. Loading the
 * mesh restores them as surface->attachment. The bytes begin with a word that names the format. */
struct server_attachment {
    void *bytes; /* malloc'ed */
    size_t size; /* at least 1; counted as SERVER_BUDGET_FLIGHT */
};

/* Allocates an attachment of zeros. On failure, returns false with the problem. */
bool server_attachment_create(struct server_attachment *attachment, size_t size,
                              struct server_budget *budget, struct proto_problem *problem);
void server_attachment_free(const struct server_attachment *attachment,
                            struct server_budget *budget);

struct server_derived_mesh {
    struct server_surface *surface;
    char *file;  /* record->size bytes */
    bool is_new; /* set when the mesh is stored; true if the name was free */
};

#define SERVER_DERIVED_MESHES_MOST 64 /* largest number of meshes of one request */

struct server_derived_meshes {        /* all zero at first */
    struct server_exchange *exchange; /* set by the caller; NULL means that no mesh was added */
    struct server_derived_mesh list[SERVER_DERIVED_MESHES_MOST];
    uint32_t count;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT */
};

void server_derived_meshes_free(struct server_derived_meshes *meshes); /* accepts all zero */

/* The structs are borrowed; server_derived_meshes_add takes over the bytes of the attachment. */
struct server_derived_source {
    const struct gd_polygons *polygons;
    const struct gd_mesh *mesh; /* their mesh, if it is built already; otherwise NULL */
    const struct server_attachment *attachment; /* NULL means that there is none */
};

/* Builds a mesh to be stored under that name of the exchange's tenant. Takes over the bytes of the
 * attachment, even when it fails. Returns false with the problem in these cases: the name is
 * invalid or repeated, the polygons are not a mesh or are too large, there are more than
 * SERVER_DERIVED_MESHES_MOST meshes, or memory is short. */
bool server_derived_meshes_add(struct server_derived_meshes *meshes, const char *name,
                               const struct server_derived_source *source,
                               struct proto_problem *problem);

/* Stores all meshes, and replaces surfaces of the same names. Returns CREATED if all names were
 * free, otherwise REPLACED. Runs on the registry's writer thread. If server_registry_put fails,
 * returns its outcome and removes the meshes that were newly created. */
enum server_outcome server_derived_meshes_store(struct server_derived_meshes *meshes);

/* Replies with the descriptions of all meshes, 201 or 200, or with the problem of the outcome. */
void server_derived_meshes_reply(const struct server_derived_meshes *meshes,
                                 enum server_outcome outcome);
