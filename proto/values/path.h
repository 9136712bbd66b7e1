/* Path: a polyline on the surface in an answer. */
#pragma once

#include "gd/path.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

/* Writes a path, or null if `path` is NULL. Points are {"xyz", "vertex"}, {"xyz", "edge", "t"} or
 * {"xyz", "face", "barycentric"} for geometry full, [x, y, z] for xyz, and omitted for none. */
void proto_path_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_path *path, enum proto_geometry geometry);

/* Writes points of a line into an array that the caller has begun; the geometry is full or xyz. */
void proto_points_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_point *points, uint32_t count,
                         enum proto_geometry geometry);

/* Writes the member "points" of a line, unless the geometry is none. */
void proto_member_points(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_point *points, uint32_t count,
                         enum proto_geometry geometry);

/* Returns the approximate number of bytes of `count` points in an answer. */
size_t proto_path_bytes(uint32_t count, enum proto_geometry geometry);

/* Writes one point of a path; the geometry is full or xyz. */
void proto_path_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_point *point, enum proto_geometry geometry);
