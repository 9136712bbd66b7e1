#include "proto/values/path.h"

#include <math.h>

#include "proto/values/point.h"

#define XYZ_BYTES   60 /* three coordinates of some 18 characters */
#define POINT_BYTES 120
/* bytes reserved for the last point, because the writer reserves the longest form of each number */
#define LAST_BYTES 2500

/* Returns the fields that describe a point of this kind in a request. */
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

void proto_path_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_point *point, enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ)
        proto_xyz_encode(writer, gd_point_position(mesh, point));
    else
        proto_point_encode_fields(writer, mesh, point, NAN, fields_by_kind(point->kind));
}

#define RUN 64 /* number of points whose positions are computed at a time */

static void encode_positions(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_point *points, uint32_t count)
{
    double xyz[RUN][3];
    for (uint32_t begin = 0; begin < count && !writer->failure; begin += RUN) {
        uint32_t some = count - begin < RUN ? count - begin : RUN;
        gd_points_positions(mesh, points + begin, some, xyz);
        proto_write_triples(writer, xyz, some);
    }
}

void proto_points_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_point *points, uint32_t count,
                         enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ)
        encode_positions(writer, mesh, points, count);
    else
        for (uint32_t i = 0; i < count; i++)
            proto_path_point_encode(writer, mesh, &points[i], geometry);
}

void proto_member_points(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_point *points, uint32_t count,
                         enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_NONE) return;
    proto_writer_expect(writer, proto_path_bytes(count, geometry));
    proto_member_array(writer, "points");
    proto_points_encode(writer, mesh, points, count, geometry);
    proto_write_array_end(writer);
}

size_t proto_path_bytes(uint32_t count, enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_NONE) return 0;
    return (size_t)count * (geometry == PROTO_GEOMETRY_XYZ ? XYZ_BYTES : POINT_BYTES) + LAST_BYTES;
}

void proto_path_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_path *path, enum proto_geometry geometry)
{
    if (!path) {
        proto_write_null(writer);
        return;
    }
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", path->length);
    proto_member_points(writer, mesh, path->points, path->count, geometry);
    proto_write_object_end(writer);
}
