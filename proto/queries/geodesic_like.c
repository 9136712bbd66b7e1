#include "proto/queries/geodesic_like.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/member.h"
#include "proto/values/point.h"

static_assert(PROTO_GEODESIC_REQUEST_DEGREE_MOST == GD_GEODESIC_DEGREE_MOST,
              "the contract has the limit of the engine");

const struct proto_geodesic_form proto_geodesic_between_points = {{"from", "to"},
                                                                  proto_geodesic_request_members,
                                                                  {false, false},
                                                                  {true, true}},
                                 proto_geodesic_to_curve = {{"point", "curve"},
                                                            proto_point_curve_request_members,
                                                            {false, true},
                                                            {false, true}},
                                 proto_geodesic_between_curves = {
                                     {"a", "b"},
                                     proto_nurbs_curve_distance_request_members,
                                     {true, true},
                                     {true, true}};

/* --- the request ------------------------------------------------------------------------------ */

void proto_geodesic_free(struct proto_geodesic *geodesic)
{
    for (int k = 0; k < 2; k++) proto_domain_curve_free(&geodesic->ends[k]);
}

static bool decode_control_points(const json_t *document, uint32_t degree, uint32_t *out,
                                  struct proto_problem *problem)
{
    if (!json_object_get(document, "control_points")) return true;
    if (!proto_decode_index(document, "", "control_points", out, problem)) return false;
    return (*out > degree && *out <= GD_GEODESIC_CONTROL_POINTS_MOST) ||
           proto_problem_refuse(problem, "/control_points",
                                "control_points is a whole number from %u to %u", degree + 1,
                                GD_GEODESIC_CONTROL_POINTS_MOST);
}

static bool decode_options(const json_t *document, struct proto_geodesic *out,
                           struct proto_problem *problem)
{
    const struct proto_object object = {document, "", problem};
    struct proto_geodesic_request request;
    if (!proto_geodesic_request_read(&object, &request)) return false;
    out->samples = request.samples;
    out->options = (struct gd_geodesic_options){
        .degree = request.degree, .tolerance = request.tolerance, .all_minima = request.all_minima};
    return decode_control_points(document, request.degree, &out->options.control_points, problem);
}

bool proto_geodesic_decode(const json_t *document, const struct proto_geodesic_form *form,
                           struct proto_geodesic *out, struct proto_problem *problem)
{
    struct proto_geodesic read = {.form = form};
    bool ok = proto_decode_object(document, "", form->members, problem) &&
              decode_options(document, &read, problem);
    for (int k = 0; k < 2 && ok; k++)
        ok = form->is_curve[k]
                 ? proto_domain_curve_decode(document, form->ends[k], &read.ends[k], problem)
                 : proto_domain_curve_decode_point(document, form->ends[k], &read.ends[k], problem);
    if (ok)
        *out = read;
    else
        proto_geodesic_free(&read);
    return ok;
}

/* --- the curve -------------------------------------------------------------------------------- */

static bool is_same_place(const double a[2], const double b[2])
{
    return a[0] == b[0] && a[1] == b[1];
}

/* Does the piece go on where the one before ends? At a pole it need not. */
static bool continues(const struct gd_geodesic *path, uint32_t piece)
{
    if (piece == 0) return false;
    const struct gd_geodesic_piece *before = &path->pieces[piece - 1];
    return is_same_place(before->points[before->count - 1], path->pieces[piece].points[0]);
}

static void encode_control_points(struct proto_writer *writer, const struct gd_geodesic *path)
{
    proto_member_array(writer, "control_points");
    for (uint32_t i = 0; i < path->piece_count; i++)
        for (uint32_t k = continues(path, i); k < path->pieces[i].count; k++)
            proto_write_numbers(writer, path->pieces[i].points[k], 2);
    proto_write_array_end(writer);
}

/* Piece i on [i, i + 1]. Where two of them share a control point its knot has the multiplicity of
 * the degree, else one more. */
static void encode_knots(struct proto_writer *writer, const struct gd_geodesic *path)
{
    proto_member_array(writer, "knots");
    for (uint32_t i = 0; i < path->piece_count; i++) {
        const struct gd_geodesic_piece *piece = &path->pieces[i];
        bool is_last = i + 1 == path->piece_count;
        if (i == 0) proto_write_number(writer, 0);
        uint32_t shared = is_last || !continues(path, i + 1) ? 0 : 1;
        for (uint32_t k = i == 0 ? 1 : piece->degree + 1;
             k < piece->count + piece->degree + 1 - shared; k++)
            proto_write_number(writer, piece->knots[k] + i);
    }
    proto_write_array_end(writer);
}

static void encode_sample(struct proto_writer *writer, const double uv[2], struct gd_vec3 xyz,
                          enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ) {
        proto_xyz_encode(writer, xyz);
        return;
    }
    proto_write_object_begin(writer);
    proto_member_numbers(writer, "uv", uv, 2);
    proto_member_xyz(writer, "xyz", xyz);
    proto_write_object_end(writer);
}

static double clamp(const struct gd_axis *axis, double t)
{
    return axis->closed ? t : fmin(fmax(t, axis->low), axis->high);
}

/* Of a place that may have left the domain by rounding. */
static struct gd_vec3 position(const struct gd_parametric *surface, const double uv[2])
{
    struct gd_jet jet = {.x = {NAN, NAN, NAN}};
    double u = clamp(gd_parametric_axis_u(surface), uv[0]),
           v = clamp(gd_parametric_axis_v(surface), uv[1]);
    (void)!gd_parametric_evaluate(surface, u, v, &jet);
    return jet.x;
}

struct samples { /* all zero is an empty list */
    double (*uv)[2];
    struct gd_vec3 *xyz;
    uint32_t count;
};

static enum gd_status sample(const struct gd_parametric *surface, const struct gd_geodesic *path,
                             uint32_t count, struct samples *out)
{
    out->count = path->piece_count ? count : 1;
    out->uv = malloc(out->count * sizeof *out->uv);
    out->xyz = malloc(out->count * sizeof *out->xyz);
    if (!out->uv || !out->xyz) return GD_NO_MEMORY;
    if (path->piece_count) return gd_geodesic_sample(surface, path, count, out->uv, out->xyz);
    memcpy(out->uv[0], path->meeting, sizeof path->meeting);
    out->xyz[0] = position(surface, path->meeting);
    return GD_OK;
}

static enum gd_status encode_points(struct proto_writer *writer,
                                    const struct gd_parametric *surface,
                                    const struct gd_geodesic *path, uint32_t count,
                                    enum proto_geometry geometry)
{
    struct samples samples = {0};
    enum gd_status status = sample(surface, path, count, &samples);
    if (!status) {
        proto_member_array(writer, "points");
        for (uint32_t i = 0; i < samples.count; i++)
            encode_sample(writer, samples.uv[i], samples.xyz[i], geometry);
        proto_write_array_end(writer);
    }
    free(samples.uv);
    free(samples.xyz);
    return status;
}

/* --- the ends --------------------------------------------------------------------------------- */

/* Where the path has no direction, its length being 0, there is no angle. */
static void encode_end(struct proto_writer *writer, const struct gd_domain_curve *curve,
                       double parameter, double angle)
{
    double uv[2];
    gd_domain_curve_at(curve, parameter, uv);
    proto_write_object_begin(writer);
    if (!gd_domain_curve_is_point(curve)) proto_member_number(writer, "parameter", parameter);
    proto_member_numbers(writer, "uv", uv, 2);
    proto_member_xyz(writer, "xyz", position(gd_domain_curve_surface(curve), uv));
    if (!gd_domain_curve_is_point(curve)) proto_member_number(writer, "angle", angle);
    proto_write_object_end(writer);
}

static void encode_ends(struct proto_writer *writer, const struct proto_geodesic_answer *answer,
                        const struct gd_geodesic *path)
{
    const struct proto_geodesic_form *form = answer->request->form;
    const double parameters[2] = {path->from_parameter, path->to_parameter},
                 angles[2] = {path->from_angle, path->to_angle};
    proto_member_object(writer, "ends");
    for (int k = 0; k < 2; k++) {
        if (!form->is_told[k]) continue;
        proto_write_key(writer, form->ends[k]);
        encode_end(writer, answer->ends[k], parameters[k], path->piece_count ? angles[k] : NAN);
    }
    proto_write_object_end(writer);
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_warnings(struct proto_writer *writer, uint32_t warnings)
{
    static const struct {
        uint32_t bit;
        const char *name;
    } names[] = {{GD_GEODESIC_NOT_CONVERGED, "not_converged"},
                 {GD_GEODESIC_BOUNDARY_CONTACT, "boundary_contact"},
                 {GD_GEODESIC_CURVE_CORNER, "curve_corner"},
                 {GD_GEODESIC_THROUGH_POLE, "through_pole"},
                 {GD_GEODESIC_NOT_MINIMAL, "not_minimal"}};
    proto_write_array_begin(writer);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (warnings & names[i].bit) proto_write_string(writer, names[i].name);
    proto_write_array_end(writer);
}

static void encode_verdict(struct proto_writer *writer, const struct gd_geodesic *path,
                           const struct proto_options *options)
{
    proto_field_number(writer, options, PROTO_GEODESIC_FIELD_RESIDUAL, path->residual);
    proto_field_number(writer, options, PROTO_GEODESIC_FIELD_ERROR_ESTIMATE, path->error);
    proto_field_number(writer, options, PROTO_GEODESIC_FIELD_GEODESIC_CURVATURE, path->curvature);
    proto_field_number(writer, options, PROTO_GEODESIC_FIELD_SPEED_DEFECT, path->speed_defect);
    proto_field_uint(writer, options, PROTO_GEODESIC_FIELD_ITERATIONS, path->iterations);
    proto_field_bool(writer, options, PROTO_GEODESIC_FIELD_CONVERGED,
                     !(path->warnings & GD_GEODESIC_NOT_CONVERGED));
    proto_field_bool(writer, options, PROTO_GEODESIC_FIELD_IS_MINIMUM, path->is_minimum);
    proto_field_bool(writer, options, PROTO_GEODESIC_FIELD_BOUNDARY_CONTACT,
                     path->warnings & GD_GEODESIC_BOUNDARY_CONTACT);
    if (proto_field(writer, options, PROTO_GEODESIC_FIELD_WARNINGS))
        encode_warnings(writer, path->warnings);
}

/* The members of one path's object. */
static enum gd_status encode_path(struct proto_writer *writer,
                                  const struct proto_geodesic_answer *answer,
                                  const struct gd_geodesic *path,
                                  const struct proto_options *options)
{
    uint32_t fields = options->fields;
    enum gd_status status = GD_OK;
    proto_field_number(writer, options, PROTO_GEODESIC_FIELD_LENGTH, path->length);
    if (path->piece_count)
        proto_field_uint(writer, options, PROTO_GEODESIC_FIELD_DEGREE, path->pieces[0].degree);
    if (fields & PROTO_GEODESIC_FIELD_KNOTS) encode_knots(writer, path);
    if (fields & PROTO_GEODESIC_FIELD_CONTROL_POINTS) encode_control_points(writer, path);
    if (fields & PROTO_GEODESIC_FIELD_POINTS && options->geometry != PROTO_GEOMETRY_NONE)
        status = encode_points(writer, gd_domain_curve_surface(answer->ends[0]), path,
                               answer->request->samples, options->geometry);
    if (fields & PROTO_GEODESIC_FIELD_ENDS) encode_ends(writer, answer, path);
    encode_verdict(writer, path, options);
    return status;
}

static enum gd_status encode_minima(struct proto_writer *writer,
                                    const struct proto_geodesic_answer *answer,
                                    const struct proto_options *options)
{
    enum gd_status status = GD_OK;
    proto_member_array(writer, "minima");
    for (uint32_t i = 0; i < answer->found->count && !status; i++) {
        if (!answer->found->items[i].is_minimum) continue;
        proto_write_object_begin(writer);
        status = encode_path(writer, answer, &answer->found->items[i], options);
        proto_write_object_end(writer);
    }
    proto_write_array_end(writer);
    return status;
}

enum gd_status proto_geodesic_encode(struct proto_writer *writer,
                                     const struct proto_geodesic_answer *answer,
                                     const struct proto_options *options)
{
    proto_write_object_begin(writer);
    enum gd_status status = encode_path(writer, answer, &answer->found->items[0], options);
    if (!status && answer->request->options.all_minima &&
        options->fields & PROTO_GEODESIC_FIELD_MINIMA)
        status = encode_minima(writer, answer, options);
    proto_write_object_end(writer);
    return status;
}
