#include "proto/queries/trace.h"

#include <assert.h>

#include "generated/requests.h"
#include "proto/json/writer.h"
#include "proto/values/path.h"

static_assert(PROTO_TRACE_REQUEST_STEP_LIMIT_MOST == GD_TRACE_STEPS,
              "the contract has the limit of the engine");

const char *proto_trace_end_name(enum gd_trace_end end)
{
    static const char *const names[] = {[GD_TRACE_END_LENGTH] = "length",
                                        [GD_TRACE_END_BOUNDARY] = "boundary",
                                        [GD_TRACE_END_SELF_INTERSECTION] = "self_intersection",
                                        [GD_TRACE_END_STEP_LIMIT] = "step_limit"};
    return names[end];
}

void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", trace->path.length);
    proto_member_points(writer, mesh, trace->path.points, trace->path.count, geometry);
    proto_write_key(writer, "end_direction");
    proto_direction_encode(writer, &trace->direction);
    proto_member_string(writer, "end_reason", proto_trace_end_name(trace->end));
    proto_write_object_end(writer);
}
