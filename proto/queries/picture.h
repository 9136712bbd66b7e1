/* Picture: the query string of a rendered picture of a mesh. */
#ifndef PROTO_PICTURE_H
#define PROTO_PICTURE_H

#include "gd/picture.h"
#include "proto/http/options.h"
#include "proto/values/points.h"

struct proto_picture {
    struct gd_picture picture; /* the members mesh, field and path are not set */
    const char *field;         /* an id, borrowed from the query string; NULL: none */
    bool has_source;
    struct proto_point source;
    struct proto_points stops; /* stops of the path: at least two, or none */
};

/* Reads the query string. Defaults: 800 x 600, ten isolines if there is a field, a legend, the view
 * that shows most of the path. The caller frees the result by proto_picture_free. Problems:
 * invalid_request, too_large (with the limit: pixels), insufficient_memory. */
bool proto_picture_parse(const struct proto_parameters *parameters, struct proto_picture *out,
                         struct proto_problem *problem);
void proto_picture_free(struct proto_picture *picture); /* may be called repeatedly */

#endif
