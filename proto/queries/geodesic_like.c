#include "proto/queries/geodesic_like.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/writer.h"
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
    proto_domain_curve_free(&geodesic->initial);
}

bool proto_geodesic_request_check(const struct proto_object *object,
                                  struct proto_geodesic_request *read)
{
    bool is_fine = read->control_points > read->degree &&
                   read->control_points <= GD_GEODESIC_CONTROL_POINTS_MOST;
    return !read->has_control_points || is_fine ||
           proto_problem_refuse(object->problem, "/control_points",
                                "control_points is a whole number from %u to %u", read->degree + 1,
                                GD_GEODESIC_CONTROL_POINTS_MOST);
}

static bool decode_turns(const json_t *document, struct proto_geodesic *out,
                         struct proto_problem *problem)
{
    double turns[2];
    out->has_turns = json_object_get(document, "turns") != NULL;
    if (!out->has_turns) return true;
    if (!proto_decode_numbers(document, "", "turns", 2, turns, problem)) return false;
    for (int k = 0; k < 2; k++) {
        if (turns[k] != round(turns[k]) || fabs(turns[k]) > GD_GEODESIC_TURNS_MOST)
            return proto_problem_refuse(problem, "/turns",
                                        "turns are two whole numbers from -%d to %d",
                                        GD_GEODESIC_TURNS_MOST, GD_GEODESIC_TURNS_MOST);
        out->turns[k] = (int32_t)turns[k];
    }
    return true;
}

/* Reads the members that select a class of paths: `turns` or `initial`. Only one of these and
 * `all_minima` may be given. */
static bool decode_class(const json_t *document, struct proto_geodesic *out,
                         struct proto_problem *problem)
{
    out->has_initial = json_object_get(document, "initial") != NULL;
    if (!decode_turns(document, out, problem)) return false;
    if (out->has_initial + out->has_turns + out->options.all_minima > 1)
        return proto_problem_refuse(problem, out->has_initial ? "/initial" : "/turns",
                                    "say one of initial, turns and all_minima");
    return !out->has_initial ||
           proto_domain_curve_decode_member(document, "initial", &out->initial, problem);
}

static bool decode_options(const json_t *document, struct proto_geodesic *out,
                           struct proto_problem *problem)
{
    const struct proto_object object = {document, "", problem};
    struct proto_geodesic_request request;
    if (!proto_geodesic_request_read(&object, &request)) return false;
    out->samples = request.samples;
    out->options = (struct gd_geodesic_options){.degree = request.degree,
                                                .control_points = request.control_points,
                                                .tolerance = request.tolerance,
                                                .all_minima = request.all_minima,
                                                .turn_limit = request.turn_limit};
    return decode_class(document, out, problem);
}

bool proto_geodesic_decode(const json_t *document, const struct proto_geodesic_form *form,
                           struct proto_geodesic *out, struct proto_problem *problem)
{
    struct proto_geodesic read = {.form = form};
    bool ok = proto_decode_object(document, "", form->members, problem) &&
              decode_options(document, &read, problem);
    for (int k = 0; k < 2 && ok; k++)
        ok = form->is_curve[k]
                 ? proto_domain_curve_decode_member(document, form->ends[k], &read.ends[k], problem)
                 : proto_domain_curve_decode_point(document, form->ends[k], &read.ends[k], problem);
    if (ok)
        *out = read;
    else
        proto_geodesic_free(&read);
    return ok;
}

/* --- the curve -------------------------------------------------------------------------------- */

/* Returns whether the piece begins where the preceding piece ends. This may be false at a pole. */
static bool continues(const struct gd_geodesic *path, uint32_t piece)
{
    if (piece == 0) return false;
    const struct gd_geodesic_piece *before = &path->pieces[piece - 1];
    const double *end = before->points[before->count - 1], *begin = path->pieces[piece].points[0];
    return end[0] == begin[0] && end[1] == begin[1];
}

uint32_t proto_geodesic_control_points(const struct gd_geodesic *path, double (*out)[2])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < path->piece_count; i++) {
        const struct gd_geodesic_piece *piece = &path->pieces[i];
        uint32_t shared = continues(path, i), more = piece->count - shared;
        if (out) memcpy(out[count], piece->points[shared], more * sizeof *out);
        count += more;
    }
    return count;
}

/* Writes the knots. Piece i has the parameters [i, i + 1]. If two pieces share a control point, the
 * multiplicity of the knot between them is the degree, otherwise the degree plus 1. */
uint32_t proto_geodesic_knots(const struct gd_geodesic *path, double *out)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < path->piece_count; i++) {
        const struct gd_geodesic_piece *piece = &path->pieces[i];
        bool is_last = i + 1 == path->piece_count;
        uint32_t shared = is_last || !continues(path, i + 1) ? 0 : 1;
        for (uint32_t k = i == 0 ? 0 : piece->degree + 1;
             k < piece->count + piece->degree + 1 - shared; k++) {
            if (out) out[count] = piece->knots[k] + i;
            count++;
        }
    }
    return count;
}

static enum gd_status encode_knots(struct proto_writer *writer, const struct gd_geodesic *path)
{
    uint32_t count = proto_geodesic_knots(path, NULL);
    double *knots = malloc((count + (size_t)1) * sizeof *knots);
    if (!knots) return GD_NO_MEMORY;
    proto_geodesic_knots(path, knots);
    proto_member_numbers(writer, "knots", knots, count);
    free(knots);
    return GD_OK;
}

static enum gd_status encode_control_points(struct proto_writer *writer,
                                            const struct gd_geodesic *path)
{
    uint32_t count = proto_geodesic_control_points(path, NULL);
    double(*points)[2] = malloc((count + (size_t)1) * sizeof *points);
    if (!points) return GD_NO_MEMORY;
    proto_geodesic_control_points(path, points);
    proto_member_array(writer, "control_points");
    for (uint32_t i = 0; i < count; i++) proto_write_numbers(writer, points[i], 2);
    proto_write_array_end(writer);
    free(points);
    return GD_OK;
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

/* Returns the position of parameters that may have left the domain by rounding. */
static struct gd_vec3 position(const struct gd_parametric *surface, const double uv[2])
{
    struct gd_jet jet = {.x = {NAN, NAN, NAN}};
    double u = clamp(gd_parametric_axis_u(surface), uv[0]),
           v = clamp(gd_parametric_axis_v(surface), uv[1]);
    (void)!gd_parametric_evaluate(surface, u, v, &jet);
    return jet.x;
}

uint32_t proto_geodesic_sample_count(const struct proto_geodesic *request,
                                     const struct gd_geodesic *path)
{
    return path->piece_count ? request->samples : 1;
}

enum gd_status proto_geodesic_sample(const struct proto_geodesic_answer *answer,
                                     const struct gd_geodesic *path, double (*uv)[2],
                                     struct gd_vec3 *xyz)
{
    const struct gd_parametric *surface = gd_domain_curve_surface(answer->ends[0]);
    if (path->piece_count)
        return gd_geodesic_sample(surface, path, answer->request->samples, uv, xyz);
    memcpy(uv, path->meeting, sizeof path->meeting);
    *xyz = position(surface, path->meeting);
    return GD_OK;
}

static enum gd_status encode_points(struct proto_writer *writer,
                                    const struct proto_geodesic_answer *answer,
                                    const struct gd_geodesic *path, enum proto_geometry geometry)
{
    uint32_t count = proto_geodesic_sample_count(answer->request, path);
    double(*uv)[2] = malloc(count * sizeof *uv);
    struct gd_vec3 *xyz = malloc(count * sizeof *xyz);
    enum gd_status status = uv && xyz ? proto_geodesic_sample(answer, path, uv, xyz) : GD_NO_MEMORY;
    if (!status) {
        proto_member_array(writer, "points");
        for (uint32_t i = 0; i < count; i++) encode_sample(writer, uv[i], xyz[i], geometry);
        proto_write_array_end(writer);
    }
    free(uv);
    free(xyz);
    return status;
}

/* --- the ends --------------------------------------------------------------------------------- */

/* Writes an end. A path of length 0 has no direction, and therefore no angle. */
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
        if (!form->is_answered[k]) continue;
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
                 {GD_GEODESIC_NOT_MINIMAL, "not_minimal"},
                 {GD_GEODESIC_FAMILY, "family"}};
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
    if (!proto_field(writer, options, PROTO_GEODESIC_FIELD_TURNS)) return;
    proto_write_array_begin(writer);
    for (int k = 0; k < 2; k++) proto_write_int(writer, path->turns[k]);
    proto_write_array_end(writer);
}

/* Writes the limit on the winding numbers of the classes that were searched. */
static void encode_turn_limit(struct proto_writer *writer,
                              const struct proto_geodesic_answer *answer,
                              const struct proto_options *options)
{
    const struct gd_parametric *surface = gd_domain_curve_surface(answer->ends[0]);
    bool is_closed = gd_parametric_axis_u(surface)->closed || gd_parametric_axis_v(surface)->closed;
    proto_field_uint(writer, options, PROTO_GEODESIC_FIELD_TURN_LIMIT,
                     is_closed ? answer->request->options.turn_limit : 0);
}

/* Writes the members of one path's object. */
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
    if (fields & PROTO_GEODESIC_FIELD_KNOTS) status = encode_knots(writer, path);
    if (!status && fields & PROTO_GEODESIC_FIELD_CONTROL_POINTS)
        status = encode_control_points(writer, path);
    if (!status && fields & PROTO_GEODESIC_FIELD_POINTS && options->geometry != PROTO_GEOMETRY_NONE)
        status = encode_points(writer, answer, path, options->geometry);
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
    if (answer->request->options.all_minima) encode_turn_limit(writer, answer, options);
    if (!status && answer->request->options.all_minima &&
        options->fields & PROTO_GEODESIC_FIELD_MINIMA)
        status = encode_minima(writer, answer, options);
    proto_write_object_end(writer);
    return status;
}
