#include "proto/values/path.h"

#include <math.h>

#include "proto/values/point.h"

#define XYZ_BYTES   60 /* of three coordinates of some 18 characters */
#define POINT_BYTES 120
/* more than that for the last of them, whose numbers the writer takes to be as long as can be */
#define LAST_BYTES 2500

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

void proto_path_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_point *point, enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ)
        proto_xyz_encode(writer, gd_point_position(mesh, point));
    else
        proto_point_encode_fields(writer, mesh, point, NAN, fields_by_kind(point->kind));
}

#define RUN 64 /* points whose positions are found at a time */

static void encode_positions(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_path *path)
{
    double xyz[RUN][3];
    for (uint32_t begin = 0; begin < path->count; begin += RUN) {
        uint32_t count = path->count - begin < RUN ? path->count - begin : RUN;
        gd_points_positions(mesh, path->points + begin, count, xyz);
        proto_write_triples(writer, xyz, count);
    }
}

static void encode_points(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct gd_path *path, enum proto_geometry geometry)
{
    proto_writer_expect(writer, proto_path_bytes(path, geometry));
    proto_write_array_begin(writer);
    if (geometry == PROTO_GEOMETRY_XYZ)
        encode_positions(writer, mesh, path);
    else
        for (uint32_t i = 0; i < path->count; i++)
            proto_path_point_encode(writer, mesh, &path->points[i], geometry);
    proto_write_array_end(writer);
}

size_t proto_path_bytes(const struct gd_path *path, enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_NONE) return 0;
    return (size_t)path->count * (geometry == PROTO_GEOMETRY_XYZ ? XYZ_BYTES : POINT_BYTES) +
           LAST_BYTES;
}

void proto_path_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_path *path, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_write_key(writer, "length");
    proto_write_number(writer, path->length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        encode_points(writer, mesh, path, geometry);
    }
    proto_write_object_end(writer);
}
