/* Path: a polyline on the surface in an answer. */
#ifndef PROTO_PATH_H
#define PROTO_PATH_H

#include "gd/path.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

/* Writes {"length", "points"}. geometry: full gives each point's xyz and the element that it lies
 * on ({"xyz","vertex"},
 * {"xyz","edge","t"} or {"xyz","face","barycentric"}), xyz gives [x,y,z], none leaves the points
 * out. O(points). */
void proto_path_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_path *path, enum proto_geometry geometry);

/* About how many bytes its points take. */
size_t proto_path_bytes(const struct gd_path *path, enum proto_geometry geometry);

/* One of its points; the geometry is full or xyz. */
void proto_path_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                             const struct gd_point *point, enum proto_geometry geometry);

#endif
