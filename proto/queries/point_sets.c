#include "proto/queries/point_sets.h"

#include <math.h>

bool proto_mean_request_check(const struct proto_object *object, struct proto_mean_request *read)
{
    const struct proto_reals *weights = &read->weights;
    double sum = 0;
    if (!weights->count) return true;
    if (weights->count != read->points.count)
        return proto_problem_refuse(object->problem, "/weights", "expected %u numbers",
                                    read->points.count);
    for (uint32_t i = 0; i < weights->count; i++) {
        if (weights->items[i] < 0)
            return proto_problem_refuse(object->problem, "/weights", "a weight is 0 or more");
        sum += weights->items[i];
    }
    return (sum > 0 && isfinite(sum)) ||
           proto_problem_refuse(object->problem, "/weights",
                                "one weight must be more than 0, and their sum a finite number");
}

void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_POINT))
        proto_point_encode(writer, mesh, &mean->point, NAN);
    proto_field_number(writer, options, PROTO_MEAN_FIELD_RESIDUAL, mean->residual);
    proto_field_number(writer, options, PROTO_MEAN_FIELD_SPREAD, mean->spread);
    proto_field_uint(writer, options, PROTO_MEAN_FIELD_ITERATIONS, mean->iterations);
    proto_field_bool(writer, options, PROTO_MEAN_FIELD_CONVERGED, mean->converged);
    proto_field_bool(writer, options, PROTO_MEAN_FIELD_CUT_LOCUS, mean->is_cut);
    proto_write_object_end(writer);
}

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
