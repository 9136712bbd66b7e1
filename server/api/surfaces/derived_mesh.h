/* Making: surfaces out of bytes, for an exchange that stores them; above all the meshes that the
 * daemon makes itself, of other surfaces: the parts of a cut, a discretization, a tessellation.
 * They are resources like those that are uploaded, and as durable.
 *
 *     server_making_begin(&making, exchange);
 *     ... server_making_add(&making, name, &polygons, &attachment, &problem) for each ... by a
 * worker return server_request_write(exchange, store);
 *
 *     static bool store(exchange): server_making_store(&making), then the answer about making.made
 * by the registry's writer
 *
 *     server_making_end(&making);                                                  where the
 * exchange's state is freed
 *
 * A made mesh is kept as a file in which no number is rounded: binary PLY with doubles, its
 * vertices and triangles in the order in which the polygons have them. */
#ifndef SERVER_API_SURFACES_DERIVED_MESH_H
#define SERVER_API_SURFACES_DERIVED_MESH_H

#include "gd/polygons.h"
#include "server/http/exchange.h"
#include "server/surfaces/registry.h"

/* Bytes that mean something to their maker only: it gets them back, as surface->attachment,
 * whenever the mesh is loaded. A maker begins them with a word of its own, by which it knows them.
 */
struct server_attachment {
    const void *bytes; /* borrowed */
    size_t size;       /* at least 1 */
};

struct server_made {
    struct server_surface *surface;
    char *file;  /* record->size bytes */
    bool is_new; /* once it is stored: the name was free */
};

#define SERVER_MADE_MOST 64 /* of one request */

struct server_making { /* all zero: not begun */
    struct server_exchange *exchange;
    struct server_made made[SERVER_MADE_MOST];
    uint32_t count;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT */
};

void server_making_begin(struct server_making *making, struct server_exchange *exchange);
/* a second time, or of one not begun, is harmless */
void server_making_end(struct server_making *making);

/* Makes a mesh that is to be stored under that name, of the exchange's tenant; polygons and
 * attachment (NULL: none) are borrowed. False with a problem: the name has not the form of names,
 * or an earlier one of this making has it; the polygons are no mesh, or too large; more than
 * SERVER_MADE_MOST; memory. */
bool server_making_add(struct server_making *making, const char *name,
                       const struct gd_polygons *polygons,
                       const struct server_attachment *attachment, struct proto_problem *problem);

/* Copies bytes, until a deadline or a cancel. */
GD_MUST_USE enum gd_status server_making_copy(void *to, const void *from, size_t size,
                                              const struct gd_control *control);

/* Stores all, each in the place of what its name had, by the registry's writer: CREATED (all names
 * were free) or REPLACED. Else as server_registry_put, and those that this has created are removed
 * again, as far as that can be done. */
enum server_store_outcome server_making_store(struct server_making *making);

/* The surface of a record, with its description remembered, from the bytes of its file: as a mesh
 * that is made, so what is uploaded. It takes over the record's attachment, whatever becomes of it:
 * malloc'ed and counted as SERVER_BUDGET_FLIGHT; NULL: there is none. NULL with the problem. */
struct server_surface *server_making_build(struct server_exchange *exchange,
                                           struct server_record *record, const void *bytes,
                                           void *attachment, struct proto_problem *problem);

#endif
