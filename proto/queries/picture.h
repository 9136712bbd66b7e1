/* Picture: a rendered picture of a mesh, asked for in the query string:
 *
 *     field=ID | source=POINT     distances as colours
 *     from=POINT&to=POINT&via=…   a path
 *     view=iso | 1,0.5,2          and up=y | z | 0,0,1
 *     size=800x600  isolines=10  edges  legend  background */
#ifndef PROTO_PICTURE_H
#define PROTO_PICTURE_H

#include "gd/picture.h"
#include "proto/http/options.h"
#include "proto/values/points.h"

struct proto_picture {
    struct gd_picture picture; /* without mesh, field and path */
    const char *field;         /* an id, borrowed from the query string; NULL: none */
    bool has_source;
    struct proto_point source;
    struct proto_points stops; /* of the path: at least two, or none */
};

/* What is not said has its default: 800 x 600, ten isolines where there is a field, a legend, the
 * view from which most of the path is seen. `out` is the caller's to free by proto_picture_free.
 * invalid_request, too_large (with the limit: pixels), insufficient_memory. */
bool proto_picture_parse(const struct proto_parameters *parameters, struct proto_picture *out,
                         struct proto_problem *problem);
void proto_picture_free(struct proto_picture *picture); /* a second time is harmless */

#endif
