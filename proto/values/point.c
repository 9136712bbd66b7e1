#include "proto/values/point.h"

#include <math.h>

#include "proto/json/number.h"

/* --- from compact text ------------------------------------------------------------------------ */

/* Each reader removes the part that it reads from the front of the text, or returns false. */
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
    return take_index(text, &out->vertex);
}

static bool take_edge(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_EDGE;
    return take_index(text, &out->edge[0]) && take(text, '-') && take_index(text, &out->edge[1]) &&
           take(text, ':') && take_number(text, &out->t);
}

static bool take_face(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_FACE;
    return take_index(text, &out->face) && take(text, ':') && take_triple(text, out->barycentric);
}

static bool take_xyz(const char **text, struct proto_point *out)
{
    out->form = PROTO_POINT_XYZ;
    out->has_max_snap = false;
    return take_triple(text, out->xyz);
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
    proto_place_keep(point.place, parameter);
    *out = point;
    return true;
}

/* --- onto the mesh ---------------------------------------------------------------------------- */

static struct gd_vec3 vec3(const double c[3])
{
    return (struct gd_vec3){c[0], c[1], c[2]};
}

static enum gd_status locate_xyz(const struct gd_mesh *mesh, const struct proto_point *point,
                                 struct gd_point *out, double *snap_distance,
                                 struct gd_detail *detail)
{
    struct gd_vec3 xyz = vec3(point->xyz);
    double max_snap = point->has_max_snap ? point->max_snap : -1; /* any distance */
    enum gd_status status = gd_locate_nearest(mesh, xyz, max_snap, out, detail);
    if (!status && snap_distance) *snap_distance = gd_locate_distance(mesh, xyz, out);
    return status;
}

static enum gd_status locate(const struct gd_mesh *mesh, const struct proto_point *point,
                             struct gd_point *out, double *snap_distance, struct gd_detail *detail)
{
    switch (point->form) {
    case PROTO_POINT_VERTEX:
        return gd_point_at_vertex(mesh, (struct gd_vertex){point->vertex}, out, detail);
    case PROTO_POINT_EDGE:
        return gd_point_on_edge(mesh,
                                (const struct gd_vertex[]){{point->edge[0]}, {point->edge[1]}},
                                point->t, out, detail);
    case PROTO_POINT_FACE:
        return gd_point_in_face(mesh, (struct gd_face){point->face}, point->barycentric, out,
                                detail);
    case PROTO_POINT_XYZ:
        return locate_xyz(mesh, point, out, snap_distance, detail);
    case PROTO_POINT_RAY:
        return gd_locate_first_hit(mesh, vec3(point->ray.origin), vec3(point->ray.direction), out,
                                   detail);
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

/* --- in answers ------------------------------------------------------------------------------- */

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
        break; /* a mask of several fields, not a field */
    }
}

void proto_point_encode_fields(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct gd_point *point, double snap_distance, uint32_t fields)
{
    struct gd_point_description description;
    if (writer->failure) return; /* stops early, so that long lists end soon after their deadline */
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
