#include "proto/values/direction.h"

#include <stdio.h>

#include "generated/requests.h"
#include "proto/values/point.h"

/* --- from JSON -------------------------------------------------------------------------------- */

static bool decode_object(const json_t *value, const char *place, struct proto_direction *out,
                          struct proto_problem *problem)
{
    const struct proto_object object = {value, place, problem};
    struct proto_direction_object read;
    if (!proto_decode_object(value, place, proto_direction_object_members, problem) ||
        !proto_direction_object_read(&object, &read))
        return false;
    out->has_angle = read.has_angle;
    out->angle = read.angle;
    out->xyz = (struct gd_vec3){read.xyz[0], read.xyz[1], read.xyz[2]};
    return read.has_angle || read.has_xyz ||
           proto_problem_refuse(problem, place, "a direction has an angle or xyz");
}

static bool decode_array(const json_t *value, const char *place, struct proto_direction *out,
                         struct proto_problem *problem)
{
    double xyz[3];
    if (!proto_read_numbers(value, 3, xyz))
        return proto_problem_refuse(problem, place, "a vector is an array of 3 numbers");
    out->xyz = (struct gd_vec3){xyz[0], xyz[1], xyz[2]};
    return true;
}

static bool decode(const json_t *value, const char *place, struct proto_direction *out,
                   struct proto_problem *problem)
{
    if (json_is_object(value)) return decode_object(value, place, out, problem);
    if (json_is_array(value)) return decode_array(value, place, out, problem);
    out->has_angle = json_is_number(value);
    out->angle = json_number_value(value);
    return out->has_angle ||
           proto_problem_refuse(problem, place,
                                "a direction is an angle in radians, a vector [x,y,z], or an "
                                "object with angle or xyz");
}

bool proto_direction_decode(const json_t *value, const char *pointer, struct proto_direction *out,
                            struct proto_problem *problem)
{
    struct proto_direction direction = {0};
    if (!decode(value, pointer, &direction, problem)) return false;
    snprintf(direction.place, sizeof direction.place, "%s", pointer);
    *out = direction;
    return true;
}

/* --- on the mesh ------------------------------------------------------------------------------ */

bool proto_direction_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                            const struct proto_direction *direction, struct gd_direction *out,
                            struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    enum gd_status status = direction->has_angle
                                ? gd_direction_at_angle(mesh, point, direction->angle, out, &detail)
                                : gd_direction_along(mesh, point, direction->xyz, out, &detail);
    if (!status) return true;
    proto_problem_from_status(problem, status, &detail);
    return proto_problem_at(problem, direction->place);
}

/* --- in answers ------------------------------------------------------------------------------- */

void proto_direction_encode(struct proto_writer *writer, const struct gd_direction *direction)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "angle", direction->angle);
    proto_member_xyz(writer, "xyz", direction->xyz);
    proto_write_object_end(writer);
}
