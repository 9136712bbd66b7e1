/* Vertex places: where on a subdivision surface the vertices of a mesh lie that was made of it: the mesh's attachment. */
#ifndef SERVER_HANDLERS_VERTEX_PLACES_H
#define SERVER_HANDLERS_VERTEX_PLACES_H

#include "proto/discretization.h"
#include "server/record.h"

struct server_surface;

/* Bytes of the attachment of so many vertices. */
size_t server_vertex_places_cost(uint32_t vertices);

/* The attachment of a discretization of that surface, malloc'ed, so many bytes; NULL without memory. */
void *server_vertex_places_write(const struct server_record *surface, const struct gd_discretization *fine);

/* What a mesh's attachment says, borrowed from it; false: the mesh was not made of a subdivision surface. */
bool server_vertex_places_read(const struct server_surface *mesh, struct proto_vertex_places *out);

#endif
