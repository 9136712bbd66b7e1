/* Point: a point of a surface, in requests and answers.
 *
 * Decoding checks the form and needs no mesh. Locating puts the point on a mesh and checks that it
 * exists there. */
#ifndef PROTO_POINT_H
#define PROTO_POINT_H

#include <jansson.h>

#include "gd/locate.h"
#include "gd/point.h"
#include "generated/fields.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

enum proto_point_form {
    PROTO_POINT_VERTEX,
    PROTO_POINT_EDGE,
    PROTO_POINT_FACE,
    PROTO_POINT_XYZ,
    PROTO_POINT_RAY
};

#define PROTO_POINT_PLACE 64

struct proto_point {
    enum proto_point_form form;
    char place[PROTO_POINT_PLACE]; /* its place in the request, see problem.h */
    union {
        struct gd_vertex vertex;
        struct {
            struct gd_vertex ends[2];
            double t; /* parameter along the edge, 0 at ends[0] */
        } edge;
        struct {
            struct gd_face face;
            double barycentric[3];
        } face;
        struct {
            struct gd_vec3 xyz;
            double max_snap; /* < 0: any distance is accepted */
        } xyz;
        struct {
            struct gd_vec3 origin, direction;
        } ray;
    };
};

/* Decodes JSON: an object (schema Point) or compact text. `pointer`: the JSON Pointer of `value`,
 * copied. Problem: invalid_request. */
bool proto_point_decode(const json_t *value, const char *pointer, struct proto_point *out,
                        struct proto_problem *problem);

/* Parses compact text: v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1.0,2.0,3.0. `parameter`: the name
 * of the query-string parameter, or a JSON Pointer; copied. Problem: invalid_request. */
bool proto_point_parse(const char *text, const char *parameter, struct proto_point *out,
                       struct proto_problem *problem);

/* Puts a point on a mesh. `*snap_distance`: how far an xyz point was moved; NAN for the other
 * forms. Problems at the point's place: invalid_request (no such index), point_not_on_surface. Cost
 * as in gd/point.h and gd/locate.h. */
bool proto_point_locate(const struct gd_mesh *mesh, const struct proto_point *point,
                        struct gd_point *out, double *snap_distance, struct proto_problem *problem);

/* Writes all fields of a point: face, barycentric, xyz, then vertex or edge and t if it lies on
 * one, then snap_distance unless it is NAN. */
void proto_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance);

/* As proto_point_encode, with only these fields (bits of enum proto_point_field). */
void proto_point_encode_fields(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct gd_point *point, double snap_distance, uint32_t fields);

/* Writes [x,y,z]. */
void proto_xyz_encode(struct proto_writer *writer, struct gd_vec3 xyz);

/* Write a point and a position as a member of an object. */
void proto_member_point(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance);
void proto_member_xyz(struct proto_writer *writer, const char *key, struct gd_vec3 xyz);

#endif
