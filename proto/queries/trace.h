/* Trace: straightest geodesics from a point. */
#ifndef PROTO_TRACE_H
#define PROTO_TRACE_H

#include "gd/trace.h"
#include "proto/http/options.h"
#include "proto/values/direction.h"
#include "proto/values/point.h"

/* points of a path when no limit is asked for; the most that can be is GD_TRACE_STEPS */
#define PROTO_TRACE_STEPS 100000

/* "length" and so on. Static string. */
const char *proto_trace_end_name(enum gd_trace_end end);

/* Writes {"length", "points", "end_direction", "end_reason"}; points by the geometry as in a path
 * (path.h). */
void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry);

#endif
