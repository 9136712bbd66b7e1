/* Parameters: places (u, v) of a parametric surface in requests and answers, [u, v] each, and plain
 * lists of numbers. */
#ifndef PROTO_UV_H
#define PROTO_UV_H

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

struct proto_uvs { /* all zero is an empty list */
    double (*items)[2];
    uint32_t count;
};

void proto_uvs_free(struct proto_uvs *uvs); /* leaves an empty list */

/* The member, [u, v]; it must be there. invalid_request. */
bool proto_uv_decode(const json_t *object, const char *place, const char *member, double out[2],
                     struct proto_problem *problem);

/* The member, a list of at least one and at most `most` pairs; it must be there. `place` is the
 * object's. invalid_request, too_large (with the limit), insufficient_memory. Freed by
 * proto_uvs_free. */
bool proto_uvs_decode(const json_t *object, const char *place, const char *member, uint32_t most,
                      struct proto_uvs *out, struct proto_problem *problem);

/* The member, a list of at least one and at most `most` numbers; it must be there. The same
 * problems. The caller frees `*out` by free(). */
bool proto_numbers_decode(const json_t *object, const char *place, const char *member,
                          uint32_t most, double **out, uint32_t *count,
                          struct proto_problem *problem);

/* Is the place in the surface's domain? Else point_not_on_surface at `place`. */
bool proto_uv_check(const struct gd_parametric *surface, const double uv[2], const char *place,
                    struct proto_problem *problem);

#endif
