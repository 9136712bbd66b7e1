/* Made mesh: a smooth surface as a mesh, by discretization of a subdivision surface or tessellation
 * of a parametric one; and where on the surface the mesh's vertices lie. */
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

/* `max_faces` is what a mesh may have. invalid_request. */
bool proto_discretization_decode(const json_t *document, const struct gd_subdivision *surface,
                                 uint32_t max_faces, struct proto_discretization *out,
                                 struct proto_problem *problem);

/* Where the vertices of a mesh lie on the surface that it was made of; all borrowed. */
struct proto_vertex_places {
    const char *surface, *etag; /* name and version */
    const struct gd_limit_point *items;
    uint32_t count;
};

/* Writes {"subdivision": {"name", "etag"}, "places": [[face, corner, u, v]…]}, of these the wanted
 * ones. */
void proto_vertex_places_encode(struct proto_writer *writer,
                                const struct proto_vertex_places *places, uint32_t fields);

struct proto_tessellation {
    struct proto_name mesh;
    struct gd_tessellation_options options;
};

/* `max_faces` is what a mesh may have. invalid_request, too_large (with the limit). */
bool proto_tessellation_decode(const json_t *document, uint32_t max_faces,
                               struct proto_tessellation *out, struct proto_problem *problem);

/* Where the vertices of a mesh lie on the surface that it was made of; all borrowed. */
struct proto_vertex_parameters {
    const char *surface, *etag; /* name and version */
    double period[2];           /* of u, v; 0: that direction is not closed */
    const double (*uv)[2];
    uint32_t count;
};

/* Writes {"nurbs": {"name", "etag"}, "periods": [u, v], "uv": [[u, v]…]}, of these the wanted ones;
 * null for the period of a direction without one. */
void proto_vertex_parameters_encode(struct proto_writer *writer,
                                    const struct proto_vertex_parameters *parameters,
                                    uint32_t fields);

#endif
