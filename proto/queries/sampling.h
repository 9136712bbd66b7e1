/* Sampling: points that cover a surface evenly. The request is {"count", "start"?}. */
#ifndef PROTO_SAMPLING_H
#define PROTO_SAMPLING_H

#include "proto/http/options.h"
#include "proto/values/points.h"

#define PROTO_SAMPLING_POINTS 10000 /* most points */

struct proto_sampling {
    uint32_t count;
    bool has_start;
    struct proto_point start;
};

/* Fields of the answer, as bits of proto_options.fields. */
enum proto_sampling_field {
    PROTO_SAMPLING_FIELD_POINTS = 1 << 0,
    PROTO_SAMPLING_FIELD_RADII = 1 << 1
};
extern const char *const proto_sampling_fields[]; /* NULL-terminated, for proto_options_parse */

/* invalid_request, too_large (with the limit). */
bool proto_sampling_decode(const json_t *document, struct proto_sampling *out,
                           struct proto_problem *problem);

/* Writes {"points", "radii"}, of these the wanted ones. Points are as elsewhere, by the geometry
 * [x,y,z] or left out; a radius that is not finite is null. `snap`: how far the first point was
 * moved; NAN: it was not. */
void proto_sampling_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_point *points, const double *radii, uint32_t count,
                           double snap, const struct proto_options *options);

#endif
