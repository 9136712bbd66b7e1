/* Mean: the weighted mean of points of a surface. */
#ifndef PROTO_MEAN_H
#define PROTO_MEAN_H

#include "gd/mean.h"
#include "generated/requests.h"
#include "proto/http/options.h"

/* The weights of a request's points, by malloc; NULL: equal ones. invalid_request,
 * insufficient_memory. */
bool proto_mean_weights_decode(const json_t *document, uint32_t count, double **out,
                               struct proto_problem *problem);

void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options);

#endif
