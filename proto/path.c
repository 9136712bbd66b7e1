#include "proto/path.h"

#include <math.h>

#include "proto/point.h"

/* The element that a point lies on and no more: what names it again in a request. */
static uint32_t fields_by_kind(enum gd_point_kind kind)
{
    switch (kind) {
    case GD_POINT_VERTEX:
        return PROTO_POINT_FIELD_XYZ | PROTO_POINT_FIELD_VERTEX;
    case GD_POINT_EDGE:
        return PROTO_POINT_FIELD_XYZ | PROTO_POINT_FIELD_EDGE | PROTO_POINT_FIELD_T;
    case GD_POINT_FACE:
        break;
    }
    return PROTO_POINT_FIELD_XYZ | PROTO_POINT_FIELD_FACE | PROTO_POINT_FIELD_BARYCENTRIC;
}

void proto_path_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh, const struct gd_point *point,
                             enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ)
        proto_xyz_encode(writer, gd_point_position(mesh, point));
    else
        proto_point_encode_fields(writer, mesh, point, NAN, fields_by_kind(point->kind));
}

void proto_path_encode(struct proto_writer *writer, const struct gd_mesh *mesh, const struct gd_path *path,
                       enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_write_key(writer, "length");
    proto_write_number(writer, path->length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < path->count; i++) proto_path_point_encode(writer, mesh, &path->points[i], geometry);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
