#include "proto/values/point.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/number.h"

static struct gd_vec3 vec3(const double c[3])
{
    return (struct gd_vec3){c[0], c[1], c[2]};
}

/* --- from JSON -------------------------------------------------------------------------------- */

static bool decode_vertex(const json_t *value, const char *place, struct proto_point *out,
                          struct proto_problem *problem)
{
    return proto_decode_index(value, place, "vertex", &out->vertex.index, problem);
}

static bool decode_edge(const json_t *value, const char *place, struct proto_point *out,
                        struct proto_problem *problem)
{
    uint32_t ends[2];
    if (!proto_decode_indices(value, place, "edge", 2, ends, problem)) return false;
    for (int i = 0; i < 2; i++) out->edge.ends[i].index = ends[i];
    return proto_decode_number(value, place, "t", &out->edge.t, problem);
}

static bool decode_face(const json_t *value, const char *place, struct proto_point *out,
                        struct proto_problem *problem)
{
    return proto_decode_index(value, place, "face", &out->face.face.index, problem) &&
           proto_decode_numbers(value, place, "barycentric", 3, out->face.barycentric, problem);
}

static bool decode_xyz(const json_t *value, const char *place, struct proto_point *out,
                       struct proto_problem *problem)
{
    double xyz[3], max_snap = -1;
    if (!proto_decode_numbers(value, place, "xyz", 3, xyz, problem)) return false;
    if (json_object_get(value, "max_snap")) {
        if (!proto_decode_number(value, place, "max_snap", &max_snap, problem)) return false;
        if (max_snap < 0)
            return proto_problem_refuse_member(
                problem, place, "max_snap",
                "max_snap is a distance: 0 or more, or leave it out for any");
    }
    out->xyz.xyz = vec3(xyz);
    out->xyz.max_snap = max_snap;
    return true;
}

static bool decode_ray(const json_t *value, const char *place, struct proto_point *out,
                       struct proto_problem *problem)
{
    static const char *const members[] = {"origin", "direction", NULL};
    char ray_place[PROTO_POINT_PLACE + 8];
    double origin[3], direction[3];
    snprintf(ray_place, sizeof ray_place, "%s/ray", place);
    const json_t *ray = json_object_get(value, "ray");
    if (!proto_decode_object(ray, ray_place, members, problem)) return false;
    if (!proto_decode_numbers(ray, ray_place, "origin", 3, origin, problem)) return false;
    if (!proto_decode_numbers(ray, ray_place, "direction", 3, direction, problem)) return false;
    out->ray.origin = vec3(origin);
    out->ray.direction = vec3(direction);
    return true;
}

/* The first member of a form names it: no other form has that member. */
static const struct form {
    const char *members[3];
    bool (*decode)(const json_t *value, const char *place, struct proto_point *out,
                   struct proto_problem *problem);
} forms[] = {
    [PROTO_POINT_VERTEX] = {{"vertex"}, decode_vertex},
    [PROTO_POINT_EDGE] = {{"edge", "t"}, decode_edge},
    [PROTO_POINT_FACE] = {{"face", "barycentric"}, decode_face},
    [PROTO_POINT_XYZ] = {{"xyz", "max_snap"}, decode_xyz},
    [PROTO_POINT_RAY] = {{"ray"}, decode_ray},
};
#define FORM_COUNT  (sizeof forms / sizeof forms[0])
#define FORMS_KNOWN "vertex; edge and t; face and barycentric; xyz and perhaps max_snap; ray"

static const char *const all_members[] = {"vertex", "edge",     "t",   "face", "barycentric",
                                          "xyz",    "max_snap", "ray", NULL};

/* Finds the only form whose first member is present. */
static bool find_form(const json_t *value, const char *place, enum proto_point_form *out,
                      struct proto_problem *problem)
{
    if (!proto_decode_object(value, place, all_members, problem)) return false;
    unsigned found = 0;
    for (unsigned form = 0; form < FORM_COUNT; form++) {
        if (!json_object_get(value, forms[form].members[0])) continue;
        *out = (enum proto_point_form)form;
        found++;
    }
    return found == 1 ||
           proto_problem_refuse(problem, place, "a point is exactly one of: " FORMS_KNOWN);
}

static void set_place(struct proto_point *point, const char *place)
{
    size_t size = strnlen(place, sizeof point->place - 1);
    memcpy(point->place, place, size);
    point->place[size] = '\0';
}

bool proto_point_decode(const json_t *value, const char *pointer, struct proto_point *out,
                        struct proto_problem *problem)
{
    struct proto_point point;
    if (json_is_string(value))
        return proto_point_parse(json_string_value(value), pointer, out, problem);
    if (!find_form(value, pointer, &point.form, problem)) return false;
    if (!proto_decode_object(value, pointer, forms[point.form].members, problem)) return false;
    if (!forms[point.form].decode(value, pointer, &point, problem)) return false;
    set_place(&point, pointer);
    *out = point;
    return true;
}

/* --- from compact text ------------------------------------------------------------------------ */

/* Each reader removes what it reads from the front of the text, or returns false. */
static bool take(const char **text, char character)
{
    if (**text != character) return false;
    ++*text;
    return true;
}

static bool take_index(const char **text, uint32_t *out)
{
    uint64_t value;
    size_t length = proto_integer_parse(*text, &value);
    if (length == 0 || value >= UINT32_MAX) return false;
    *text += length;
    *out = (uint32_t)value;
    return true;
}

static bool take_number(const char **text, double *out)
{
    size_t length = proto_number_parse(*text, out);
    *text += length;
    return length > 0;
}

static bool take_triple(const char **text, double out[3])
{
    return take_number(text, &out[0]) && take(text, ',') && take_number(text, &out[1]) &&
           take(text, ',') && take_number(text, &out[2]);
}

static bool take_vertex(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_VERTEX;
    return take_index(text, &out->vertex.index);
}

static bool take_edge(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_EDGE;
    return take_index(text, &out->edge.ends[0].index) && take(text, '-') &&
           take_index(text, &out->edge.ends[1].index) && take(text, ':') &&
           take_number(text, &out->edge.t);
}

static bool take_face(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_FACE;
    return take_index(text, &out->face.face.index) && take(text, ':') &&
           take_triple(text, out->face.barycentric);
}

static bool take_xyz(const char **text, struct proto_point *out)
{
    double xyz[3];
    if (!take_triple(text, xyz)) return false;
    out->form = PROTO_POINT_XYZ;
    out->xyz.xyz = vec3(xyz);
    out->xyz.max_snap = -1;
    return true;
}

static bool take_point(const char **text, struct proto_point *out)
{
    char letter = **text;
    if (letter == '\0' || !take(text, letter) || !take(text, ':')) return false;
    switch (letter) {
    case 'v':
        return take_vertex(text, out);
    case 'e':
        return take_edge(text, out);
    case 'f':
        return take_face(text, out);
    case 'p':
        return take_xyz(text, out);
    default:
        return false;
    }
}

bool proto_point_parse(const char *text, const char *parameter, struct proto_point *out,
                       struct proto_problem *problem)
{
    struct proto_point point;
    if (!take_point(&text, &point) || *text != '\0')
        return proto_problem_refuse(
            problem, parameter,
            "expected a point: v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1.0,2.0,3.0");
    set_place(&point, parameter);
    *out = point;
    return true;
}

/* --- onto the mesh ---------------------------------------------------------------------------- */

static enum gd_status locate_xyz(const struct gd_mesh *mesh, const struct proto_point *point,
                                 struct gd_point *out, double *snap_distance,
                                 struct gd_detail *detail)
{
    struct gd_vec3 xyz = point->xyz.xyz;
    enum gd_status status = gd_locate_nearest(mesh, xyz, point->xyz.max_snap, out, detail);
    if (!status && snap_distance) *snap_distance = gd_locate_distance(mesh, xyz, out);
    return status;
}

static enum gd_status locate(const struct gd_mesh *mesh, const struct proto_point *point,
                             struct gd_point *out, double *snap_distance, struct gd_detail *detail)
{
    switch (point->form) {
    case PROTO_POINT_VERTEX:
        return gd_point_at_vertex(mesh, point->vertex, out, detail);
    case PROTO_POINT_EDGE:
        return gd_point_on_edge(mesh, point->edge.ends, point->edge.t, out, detail);
    case PROTO_POINT_FACE:
        return gd_point_in_face(mesh, point->face.face, point->face.barycentric, out, detail);
    case PROTO_POINT_XYZ:
        return locate_xyz(mesh, point, out, snap_distance, detail);
    case PROTO_POINT_RAY:
        return gd_locate_first_hit(mesh, point->ray.origin, point->ray.direction, out, detail);
    }
    return GD_INTERNAL;
}

bool proto_point_locate(const struct gd_mesh *mesh, const struct proto_point *point,
                        struct gd_point *out, double *snap_distance, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    double snap = NAN;
    enum gd_status status = locate(mesh, point, out, &snap, &detail);
    if (status != GD_OK) {
        proto_problem_from_status(problem, status, &detail);
        return proto_problem_at(problem, point->place);
    }
    *snap_distance = snap;
    return true;
}

/* --- back to the client ----------------------------------------------------------------------- */

void proto_xyz_encode(struct proto_writer *writer, struct gd_vec3 xyz)
{
    proto_write_numbers(writer, (const double[]){xyz.x, xyz.y, xyz.z}, 3);
}

/* Returns the fields that this point has. */
static uint32_t fields_of(const struct gd_point_description *point, double snap_distance)
{
    uint32_t fields =
        PROTO_POINT_FIELD_FACE | PROTO_POINT_FIELD_BARYCENTRIC | PROTO_POINT_FIELD_XYZ;
    if (point->kind == GD_POINT_VERTEX) fields |= PROTO_POINT_FIELD_VERTEX;
    if (point->kind == GD_POINT_EDGE) fields |= PROTO_POINT_FIELD_EDGE | PROTO_POINT_FIELD_T;
    if (!isnan(snap_distance)) fields |= PROTO_POINT_FIELD_SNAP_DISTANCE;
    return fields;
}

static void encode_field(struct proto_writer *writer, const struct gd_point_description *point,
                         double snap_distance, enum proto_point_field field)
{
    switch (field) {
    case PROTO_POINT_FIELD_FACE:
        proto_write_uint(writer, point->face.index);
        break;
    case PROTO_POINT_FIELD_BARYCENTRIC:
        proto_write_numbers(writer, point->barycentric, 3);
        break;
    case PROTO_POINT_FIELD_XYZ:
        proto_xyz_encode(writer, point->xyz);
        break;
    case PROTO_POINT_FIELD_VERTEX:
        proto_write_uint(writer, point->vertex.index);
        break;
    case PROTO_POINT_FIELD_EDGE:
        proto_write_indices(writer, &point->edge->index, 2);
        break;
    case PROTO_POINT_FIELD_T:
        proto_write_number(writer, point->t);
        break;
    case PROTO_POINT_FIELD_SNAP_DISTANCE:
        proto_write_number(writer, snap_distance);
        break;
    case PROTO_POINT_FIELD_ALL:
        break; /* a mask, not a field */
    }
}

void proto_point_encode_fields(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct gd_point *point, double snap_distance, uint32_t fields)
{
    struct gd_point_description description;
    if (writer->failure) return; /* long lists end soon after their deadline */
    gd_point_describe(mesh, point, &description);
    fields &= fields_of(&description, snap_distance);
    proto_write_object_begin(writer);
    for (unsigned i = 0; proto_point_fields[i]; i++) {
        if (!(fields >> i & 1)) continue;
        proto_write_key(writer, proto_point_fields[i]);
        encode_field(writer, &description, snap_distance, (enum proto_point_field)(1u << i));
    }
    proto_write_object_end(writer);
}

void proto_point_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance)
{
    proto_point_encode_fields(writer, mesh, point, snap_distance, PROTO_POINT_FIELD_ALL);
}

void proto_member_point(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                        const struct gd_point *point, double snap_distance)
{
    proto_write_key(writer, key);
    proto_point_encode(writer, mesh, point, snap_distance);
}

void proto_member_xyz(struct proto_writer *writer, const char *key, struct gd_vec3 xyz)
{
    proto_write_key(writer, key);
    proto_xyz_encode(writer, xyz);
}
