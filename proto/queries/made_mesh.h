/* Made mesh: the requests that make a mesh from a smooth surface: a discretization of a subdivision
 * surface, or a tessellation of a parametric surface. */
#pragma once

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

struct proto_tessellation {
    struct proto_name mesh;
    struct gd_tessellation_options options;
};

/* Decodes the body of a request. `max_faces` is the limit on the mesh's faces. Problems:
 * invalid_request, too_large (with the limit). */
bool proto_tessellation_decode(const json_t *document, uint32_t max_faces,
                               struct proto_tessellation *out, struct proto_problem *problem);
