#include "proto/queries/trace.h"

#include <assert.h>

#include "generated/requests.h"
#include "proto/json/member.h"
#include "proto/values/path.h"

static_assert(PROTO_TRACE_REQUEST_STEP_LIMIT_MOST == GD_TRACE_STEPS,
              "the contract has the limit of the engine");

const char *proto_trace_end_name(enum gd_trace_end end)
{
    switch (end) {
    case GD_TRACE_END_BOUNDARY:
        return "boundary";
    case GD_TRACE_END_SELF_INTERSECTION:
        return "self_intersection";
    case GD_TRACE_END_STEP_LIMIT:
        return "step_limit";
    case GD_TRACE_END_LENGTH:
        break;
    }
    return "length";
}

void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", trace->path.length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_member_array(writer, "points");
        for (uint32_t i = 0; i < trace->path.count; i++)
            proto_path_point_encode(writer, mesh, &trace->path.points[i], geometry);
        proto_write_array_end(writer);
    }
    proto_write_key(writer, "end_direction");
    proto_direction_encode(writer, &trace->direction);
    proto_member_string(writer, "end_reason", proto_trace_end_name(trace->end));
    proto_write_object_end(writer);
}
