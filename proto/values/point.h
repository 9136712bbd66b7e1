/* Point: a point of a surface, in requests and answers.
 *
 * Decoding checks the form and needs no mesh. Locating moves the point onto a mesh, and checks that
 * the point exists there. */
#pragma once

#include <jansson.h>

#include "gd/locate.h"
#include "gd/point.h"
#include "generated/fields.h"
#include "generated/values.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

/* struct proto_point and proto_point_decode, which reads JSON, are in generated/values.h. */

/* Parses compact text: v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1.0,2.0,3.0. `parameter` is the name
 * of the query-string parameter, or a JSON Pointer; copied. Problem: invalid_request. */
bool proto_point_parse(const char *text, const char *parameter, struct proto_point *out,
                       struct proto_problem *problem);

/* Moves a point onto a mesh. Sets `*snap_distance` to the distance by which an xyz point was moved,
 * or to NAN for the other forms. Problems at the point's place: invalid_request (no such index),
 * point_not_on_surface. Cost as in gd/point.h and gd/locate.h. */
bool proto_point_locate(const struct gd_mesh *mesh, const struct proto_point *point,
                        struct gd_point *out, double *snap_distance, struct proto_problem *problem);

/* Writes all fields of a point: face, barycentric, xyz; then vertex if the point is a vertex, or
 * edge and t if it lies on an edge; then snap_distance unless that is NAN. */
void proto_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance);

/* Like proto_point_encode, but writes only these fields (bits of enum proto_point_field). */
void proto_point_encode_fields(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct gd_point *point, double snap_distance, uint32_t fields);

/* Writes [x,y,z]. */
void proto_xyz_encode(struct proto_writer *writer, struct gd_vec3 xyz);

/* Write a point and a position as a member of an object. */
void proto_member_point(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance);
void proto_member_xyz(struct proto_writer *writer, const char *key, struct gd_vec3 xyz);
