#include "proto/queries/nearest.h"

#include "proto/json/decode.h"

const char *const proto_nearest_parameters[] = {"point", NULL};

bool proto_nearest_decode(const json_t *document, struct proto_nearest *out,
                          struct proto_problem *problem)
{
    if (!proto_decode_object(document, "", proto_nearest_parameters, problem)) return false;
    const json_t *point = proto_decode_member(document, "", "point", problem);
    return point && proto_point_decode(point, "/point", &out->point, problem);
}

bool proto_nearest_parse(const struct proto_parameters *parameters, struct proto_nearest *out,
                         struct proto_problem *problem)
{
    const char *point = proto_parameters_require(parameters, "point", problem);
    return point && proto_point_parse(point, "point", &out->point, problem);
}

void proto_nearest_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct gd_point *point, double snap_distance,
                          const struct proto_options *options)
{
    proto_point_encode_fields(writer, mesh, point, snap_distance, options->fields);
}
