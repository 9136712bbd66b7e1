/* Derived meshes: meshes that the daemon makes from another surface: the pieces of a cut, a
 * tessellation, a discretization. They are resources like uploads, and as durable.
 *
 *     server_derived_meshes_begin(&meshes, exchange);             a worker
 *     server_derived_meshes_add(&meshes, name, &polygons, …);     … for each mesh
 *     return server_request_write(exchange, store);
 *     server_derived_meshes_store(&meshes);                       `store`, by the registry's writer
 *     server_derived_meshes_free(&meshes);                        with the exchange's state
 *
 * A derived mesh is stored as binary PLY with doubles, so no coordinate is rounded; vertices and
 * triangles keep the order of the polygons. */
#ifndef SERVER_QUERY_DERIVED_MESH_H
#define SERVER_QUERY_DERIVED_MESH_H

#include "gd/polygons.h"
#include "server/query/surface_resource.h"

/* Bytes that the daemon stores with a mesh and that only their maker understands; loading the mesh
 * restores them as surface->attachment. They begin with a word that names their maker. */
struct server_attachment {
    const void *bytes; /* borrowed */
    size_t size;       /* at least 1 */
};

struct server_derived_mesh {
    struct server_surface *surface;
    char *file;  /* record->size bytes */
    bool is_new; /* once stored: the name was free */
};

#define SERVER_DERIVED_MESHES_MOST 64 /* in one request */

struct server_derived_meshes { /* all zero: not begun */
    struct server_exchange *exchange;
    struct server_derived_mesh list[SERVER_DERIVED_MESHES_MOST];
    uint32_t count;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT */
};

void server_derived_meshes_begin(struct server_derived_meshes *meshes,
                                 struct server_exchange *exchange);
void server_derived_meshes_free(struct server_derived_meshes *meshes); /* all zero is harmless */

/* Builds a mesh that is to be stored under that name of the exchange's tenant. Polygons and
 * attachment (NULL: none) are borrowed. False with the problem: an invalid or repeated name,
 * polygons that are no mesh or too large, more than SERVER_DERIVED_MESHES_MOST, memory. */
bool server_derived_meshes_add(struct server_derived_meshes *meshes, const char *name,
                               const struct gd_polygons *polygons,
                               const struct server_attachment *attachment,
                               struct proto_problem *problem);

/* Copies bytes; stops at a deadline or a cancel. */
GD_MUST_USE enum gd_status server_derived_mesh_copy(void *to, const void *from, size_t size,
                                                    const struct gd_control *control);

/* Stores all meshes, replacing what had their names: CREATED (all names were free) or REPLACED. By
 * the registry's writer. After an error, the outcome of server_registry_put, it removes the meshes
 * that it has created. */
enum server_store_outcome server_derived_meshes_store(struct server_derived_meshes *meshes);

#endif
