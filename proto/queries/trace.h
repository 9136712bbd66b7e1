/* Trace: straightest geodesics from a point. The request is {"start", "directions" | "fan",
 * "length", "vertex_rule"?, "boundary_rule"?, "stop_at_self_intersection"?, "step_limit"?}; the
 * answer is {"start", "paths"}. */
#ifndef PROTO_TRACE_H
#define PROTO_TRACE_H

#include "gd/trace.h"
#include "proto/values/direction.h"
#include "proto/http/options.h"
#include "proto/values/point.h"

#define PROTO_TRACE_DIRECTIONS 10000 /* most of them */
/* points of a path when no limit is asked for; the most that can be is GD_TRACE_STEPS */
#define PROTO_TRACE_STEPS 100000

struct proto_trace { /* all zero is an empty one */
    struct proto_point start;
    struct proto_direction *directions; /* NULL: a fan */
    uint32_t count;                     /* of directions, or of the fan */
    double length;
    struct gd_trace_options options; /* without normals; the step limit is never 0 */
};

/* invalid_request, too_large, insufficient_memory. Freed by proto_trace_free. */
bool proto_trace_decode(const json_t *document, struct proto_trace *out,
                        struct proto_problem *problem);
void proto_trace_free(struct proto_trace *trace); /* a second time is harmless */

/* Parts of a request that others have too: directions or a fan, which on failure may be there in
 * part; the rule, which is the usual one unless it is said. The same problems. */
bool proto_trace_ways_decode(const json_t *document, struct proto_trace *trace,
                             struct proto_problem *problem);
bool proto_trace_vertex_rule_decode(const json_t *document, enum gd_vertex_rule usual,
                                    enum gd_vertex_rule *out, struct proto_problem *problem);

/* "length" and so on. Static string. */
const char *proto_trace_end_name(enum gd_trace_end end);

/* Fields of the answer, as bits of proto_options.fields: its own, and those of each path. */
enum proto_trace_field { PROTO_TRACE_FIELD_START = 1 << 0, PROTO_TRACE_FIELD_PATHS = 1 << 1 };
extern const char *const proto_trace_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes {"length", "points", "end_direction", "end_reason"}; points by the geometry as in a path
 * (path.h). */
void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry);

#endif
