/* Made mesh: what requests for meshes of smooth surfaces, and answers about those, have in
 * common. */
#ifndef PROTO_MADE_MESH_H
#define PROTO_MADE_MESH_H

#include <jansson.h>

#include "proto/values/mesh.h"
#include "proto/json/writer.h"

/* The member "mesh", the name of a mesh that is to be made. invalid_request. */
bool proto_made_mesh_decode(const json_t *document, char out[PROTO_MESH_NAME + 1],
                            struct proto_problem *problem);

/* The member "tolerance", how near the mesh is to be, more than 0. invalid_request. */
bool proto_made_tolerance_decode(const json_t *document, double *out,
                                 struct proto_problem *problem);

/* Writes the member that tells of what the mesh was made: `key`: {"name", "etag"}. */
void proto_made_of_encode(struct proto_writer *writer, const char *key, const char *name,
                          const char *etag);

#endif
