/* Nearest: a point of the surface from whatever names it; the answer is the point. */
#ifndef PROTO_NEAREST_H
#define PROTO_NEAREST_H

#include "proto/http/options.h"
#include "proto/values/point.h"

struct proto_nearest {
    struct proto_point point;
};

/* Query-string parameters of the GET form: point. NULL-terminated, for proto_options_parse; the
 * answer's fields are proto_point_fields. */
extern const char *const proto_nearest_parameters[];

/* From the body of POST, {"point": point}, and from the query string of GET. invalid_request. */
bool proto_nearest_decode(const json_t *document, struct proto_nearest *out,
                          struct proto_problem *problem);
bool proto_nearest_parse(const struct proto_parameters *parameters, struct proto_nearest *out,
                         struct proto_problem *problem);

/* Writes the located point itself, of its fields those that were asked for. */
void proto_nearest_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct gd_point *point, double snap_distance,
                          const struct proto_options *options);

#endif
