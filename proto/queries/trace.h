/* Trace: straightest geodesics from a point. */
#pragma once

#include "gd/trace.h"
#include "proto/http/options.h"
#include "proto/values/direction.h"
#include "proto/values/point.h"

/* default limit on the points of a path; GD_TRACE_STEPS is the maximum */
#define PROTO_TRACE_STEPS 100000

/* Returns the name of a trace's end, a static string. */
const char *proto_trace_end_name(enum gd_trace_end end);

/* Writes a trace. The geometry selects the form of points, as in path.h. */
void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry);
