/* Made mesh: a smooth surface as a mesh, by discretization of a subdivision surface or tessellation
 * of a parametric surface; and the surface points of the mesh's vertices. */
#ifndef PROTO_MADE_MESH_H
#define PROTO_MADE_MESH_H

#include "gd/discretization.h"
#include "gd/tessellation.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/mesh.h"

struct proto_discretization {
    struct proto_name mesh;
    struct gd_discretize_options options;
};

/* Decodes the body of a request. `max_faces` is the limit on the mesh's faces. Problem:
 * invalid_request. */
bool proto_discretization_decode(const json_t *document, const struct gd_subdivision *surface,
                                 uint32_t max_faces, struct proto_discretization *out,
                                 struct proto_problem *problem);

/* For each vertex of a made mesh the point of its surface; all borrowed. */
struct proto_vertex_places {
    const char *surface, *etag; /* name and version */
    const struct gd_limit_point *items;
    uint32_t count;
};

void proto_vertex_places_encode(struct proto_writer *writer,
                                const struct proto_vertex_places *places, uint32_t fields);

struct proto_tessellation {
    struct proto_name mesh;
    struct gd_tessellation_options options;
};

/* Decodes the body of a request. `max_faces` is the limit on the mesh's faces. Problems:
 * invalid_request, too_large (with the limit). */
bool proto_tessellation_decode(const json_t *document, uint32_t max_faces,
                               struct proto_tessellation *out, struct proto_problem *problem);

/* For each vertex of a made mesh the point of its surface; all borrowed. */
struct proto_vertex_parameters {
    const char *surface, *etag; /* name and version */
    double period[2];           /* periods of u and v; 0: the direction is not closed */
    const double (*uv)[2];
    uint32_t count;
};

void proto_vertex_parameters_encode(struct proto_writer *writer,
                                    const struct proto_vertex_parameters *parameters,
                                    uint32_t fields);

#endif
