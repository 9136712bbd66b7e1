/* Picture: the query string of a picture of a mesh, and the request of a figure. */
#pragma once

#include "gd/picture.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/values/limit_place.h"
#include "proto/values/points.h"
#include "proto/values/uv.h"

struct proto_picture {
    struct gd_picture picture; /* the members mesh, field, path and layers are not set */
    const char *field;         /* an id, borrowed from the query string, or NULL */
    bool has_source;
    struct proto_point source;
    struct proto_points stops;            /* stops of the path: at least two, or none */
    struct proto_picture_request request; /* set for a figure */
    struct gd_vec3 target;
};

/* Reads the query string. Defaults: 800 x 600, ten isolines if there is a field, a legend, the view
 * that shows most of the path. The caller frees the result by proto_picture_free. Problems:
 * invalid_request, too_large (with the limit: pixels), insufficient_memory. */
bool proto_picture_parse(const struct proto_parameters *parameters, struct proto_picture *out,
                         struct proto_problem *problem);
void proto_picture_free(struct proto_picture *picture); /* may be called repeatedly */

/* Decodes the request of a figure. `out` must not be moved, because it holds pointers to its own
 * members. The bodies of layers that are operations are not decoded. The caller frees the result by
 * proto_picture_free. Problems: those of proto_picture_parse. */
bool proto_picture_decode(const json_t *document, struct proto_picture *out,
                          struct proto_problem *problem);

/* Decode the places of the layer `field` of a smooth surface. Problems: invalid_request, too_large,
 * point_not_on_surface, insufficient_memory. The caller frees the result by proto_uvs_free or
 * proto_limit_places_free. */
bool proto_picture_places_decode(const json_t *document, const struct gd_parametric *surface,
                                 struct proto_uvs *out, struct proto_problem *problem);
bool proto_picture_limit_places_decode(const json_t *document, const struct gd_subdivision *surface,
                                       struct proto_limit_places *out,
                                       struct proto_problem *problem);
