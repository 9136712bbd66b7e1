/* Vertex parameters: where on a NURBS surface the vertices of a mesh lie that was made of it: the mesh's attachment. */
#ifndef SERVER_HANDLERS_VERTEX_PARAMETERS_H
#define SERVER_HANDLERS_VERTEX_PARAMETERS_H

#include "proto/tessellation.h"
#include "server/record.h"

struct server_surface;

/* The attachment of a tessellation of that surface, malloc'ed, `*size` bytes; NULL without memory. */
void *server_vertex_parameters_write(const struct server_record *surface, const struct gd_tessellation *tessellation,
                                     size_t *size);

/* Bytes that it will have. */
size_t server_vertex_parameters_cost(const struct gd_tessellation *tessellation);

/* What a mesh's attachment says, borrowed from it; false: the mesh was not made of a NURBS surface. */
bool server_vertex_parameters_read(const struct server_surface *mesh, struct proto_vertex_parameters *out);

#endif
