#include "proto/queries/sampling.h"

#include <math.h>

void proto_sampling_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_point *points, const double *radii, uint32_t count,
                           double snap, const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (options->geometry != PROTO_GEOMETRY_NONE &&
        proto_field(writer, options, PROTO_SAMPLING_FIELD_POINTS)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < count; i++) {
            if (options->geometry == PROTO_GEOMETRY_XYZ)
                proto_xyz_encode(writer, gd_point_position(mesh, &points[i]));
            else
                proto_point_encode(writer, mesh, &points[i], i ? NAN : snap);
        }
        proto_write_array_end(writer);
    }
    if (proto_field(writer, options, PROTO_SAMPLING_FIELD_RADII))
        proto_write_numbers(writer, radii, count);
    proto_write_object_end(writer);
}
