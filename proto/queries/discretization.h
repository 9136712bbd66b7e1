/* Discretization: {"mesh", "level" | "tolerance"}, a subdivision surface as a mesh; and where on
 * the surface the mesh's vertices lie. */
#ifndef PROTO_DISCRETIZATION_H
#define PROTO_DISCRETIZATION_H

#include "gd/discretization.h"
#include "generated/requests.h"
#include "proto/values/mesh.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

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

#endif
