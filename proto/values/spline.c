#include "proto/values/spline.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "generated/requests.h"
#include "proto/json/writer.h"
#include "proto/values/path.h"

enum { PLACE = 2 * PROTO_KEPT_PLACE };

void proto_spline_free(struct proto_spline *spline)
{
    proto_points_free(&spline->points);
    free(spline->tangents);
    proto_reals_free(&spline->parameters);
    *spline = (struct proto_spline){0};
}

void proto_located_spline_free(struct proto_located_spline *located)
{
    proto_located_points_free(&located->points);
    free(located->tangents);
    *located = (struct proto_located_spline){0};
}

/* --- tangents --------------------------------------------------------------------------------- */

static bool decode_tangent(const json_t *value, const char *place, struct proto_segment *out,
                           struct proto_problem *problem)
{
    return proto_vector_check(value, place, problem) &&
           proto_segment_decode(value, place, out, problem);
}

static bool decode_tangents(const json_t *value, struct proto_spline *spline,
                            struct proto_problem *problem)
{
    const json_t *array = json_object_get(value, "tangents");
    uint32_t count = spline->points.count;
    if (!array) return true;
    if (!json_is_array(array) || json_array_size(array) != count)
        return proto_problem_refuse_member(
            problem, spline->place, "tangents",
            "expected an array with a vector or null for each point");
    spline->tangents = calloc(count, sizeof *spline->tangents + sizeof *spline->is_given);
    if (!spline->tangents) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    spline->is_given = (bool *)(spline->tangents + count);
    for (uint32_t i = 0; i < count; i++) {
        char place[PLACE];
        const json_t *tangent = json_array_get(array, i);
        snprintf(place, sizeof place, "%s/tangents/%u", spline->place, i);
        spline->is_given[i] = !json_is_null(tangent);
        if (spline->is_given[i] && !decode_tangent(tangent, place, &spline->tangents[i], problem))
            return false;
    }
    return true;
}

static const char only_at_parameters[] = "de_casteljau needs samples or at, which are parameters";

/* --- samples -------------------------------------------------------------------- */

static bool decode_samples(const struct proto_spline_request *request, struct proto_spline *spline,
                           struct proto_problem *problem)
{
    uint32_t samples = request->samples, segments = spline->points.count - !spline->closed;
    if ((double)samples * segments > PROTO_SPLINE_PLACES)
        return proto_problem_refuse_member(
            problem, spline->place, "samples",
            "samples is a number from 1 on, and at most %d for all segments", PROTO_SPLINE_PLACES);
    if (request->speed == PROTO_SPEED_CONSTANT &&
        request->evaluation == PROTO_EVALUATION_DE_CASTELJAU)
        return proto_problem_refuse_member(problem, spline->place, "evaluation", "%s",
                                           only_at_parameters);
    if (request->speed == PROTO_SPEED_CONSTANT)
        spline->sampling.even = samples * segments;
    else
        spline->sampling.per_segment = samples;
    return true;
}

static bool decode_sampling(const json_t *value, const struct proto_spline_request *request,
                            struct proto_spline *spline, struct proto_problem *problem)
{
    bool has_samples = json_object_get(value, "samples"), has_at = request->at.count > 0;
    int ways = has_samples + has_at + request->has_tolerance + request->has_spacing;
    if (ways > 1)
        return proto_problem_refuse(problem, spline->place,
                                    "say one of samples, tolerance, spacing and at");
    if (!ways || has_samples) return decode_samples(request, spline, problem);
    if (json_object_get(value, "speed"))
        return proto_problem_refuse_member(problem, spline->place, "speed",
                                           "speed needs samples; spacing always has constant "
                                           "speed");
    if (request->evaluation == PROTO_EVALUATION_DE_CASTELJAU && !has_at)
        return proto_problem_refuse_member(problem, spline->place, "evaluation", "%s",
                                           only_at_parameters);
    spline->sampling.tolerance = request->tolerance;
    spline->sampling.spacing = request->spacing;
    spline->sampling.parameters = request->at.items;
    spline->sampling.count = request->at.count;
    return true;
}

static bool decode(const json_t *value, bool as_curve, struct proto_spline *spline,
                   struct proto_problem *problem)
{
    const struct proto_object object = {value, spline->place, problem};
    struct proto_spline_request request;
    if (!proto_decode_object(value, spline->place,
                             as_curve ? proto_spline_curve_members : proto_spline_request_members,
                             problem) ||
        !proto_spline_request_read(&object, &request))
        return false;
    spline->points = request.points;
    spline->parameters = request.at;
    spline->closed = request.closed;
    spline->frames = request.frames;
    spline->alpha = request.alpha;
    spline->tension = request.tension;
    spline->tangent_rule =
        request.tangent_rule == PROTO_TANGENT_RULE_PAPER ? GD_TANGENT_PAPER : GD_TANGENT_SYMMETRIC;
    spline->end_rule = request.end_rule == PROTO_END_RULE_ZERO ? GD_END_ZERO : GD_END_NATURAL;
    if (request.evaluation == PROTO_EVALUATION_DE_CASTELJAU)
        spline->sampling.evaluation = GD_SPLINE_DE_CASTELJAU;
    return decode_tangents(value, spline, problem) &&
           decode_sampling(value, &request, spline, problem);
}

static bool decode_at(const json_t *value, const char *place, bool as_curve,
                      struct proto_spline *out, struct proto_problem *problem)
{
    struct proto_spline spline = {0};
    proto_place_keep(spline.place, place);
    bool ok = decode(value, as_curve, &spline, problem);
    if (ok)
        *out = spline;
    else
        proto_spline_free(&spline);
    return ok;
}

bool proto_spline_decode(const json_t *document, struct proto_spline *out,
                         struct proto_problem *problem)
{
    return decode_at(document, "", false, out, problem);
}

bool proto_spline_curve_decode(const json_t *value, const char *place, struct proto_spline *out,
                               struct proto_problem *problem)
{
    return decode_at(value, place, true, out, problem);
}

/* --- on the mesh ------------------------------------------------------------------------------ */

static bool locate_tangents(const struct gd_mesh *mesh, const struct proto_spline *spline,
                            struct proto_located_spline *located, struct proto_problem *problem)
{
    uint32_t count = spline->points.count;
    if (!spline->tangents) return true;
    located->tangents = calloc(count, sizeof *located->tangents + sizeof *located->is_given);
    if (!located->tangents) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    located->is_given = (bool *)(located->tangents + count);
    for (uint32_t i = 0; i < count; i++) {
        located->is_given[i] = spline->is_given[i];
        if (spline->is_given[i] &&
            !proto_segment_locate(mesh, &located->points.points[i], &spline->tangents[i],
                                  &located->tangents[i], problem))
            return false;
    }
    return true;
}

bool proto_spline_locate(const struct gd_mesh *mesh, const struct proto_spline *spline,
                         struct proto_located_spline *out, struct proto_problem *problem)
{
    struct proto_located_spline located = {.sampling = spline->sampling};
    if (!proto_points_locate(mesh, &spline->points, &located.points, problem)) return false;
    if (!locate_tangents(mesh, spline, &located, problem)) {
        proto_located_spline_free(&located);
        return false;
    }
    located.request = (struct gd_spline_request){.points = located.points.points,
                                                 .count = located.points.count,
                                                 .closed = spline->closed,
                                                 .alpha = spline->alpha,
                                                 .tension = spline->tension,
                                                 .tangent_rule = spline->tangent_rule,
                                                 .end_rule = spline->end_rule,
                                                 .tangents = located.tangents,
                                                 .is_given = located.is_given};
    *out = located;
    return true;
}

bool proto_spline_fail(const char *place, enum gd_status status, struct gd_detail *detail,
                       struct proto_problem *problem)
{
    char where[PLACE];
    snprintf(where, sizeof where, "%s", place);
    if (detail->count)
        snprintf(where, sizeof where, "%s/points/%u", place, (unsigned)detail->elements[0][0]);
    detail->count = 0;
    detail->total = 0;
    proto_problem_from_status(problem, status, detail);
    if (detail->text[0]) proto_problem_at(problem, where);
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_segment(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_spline_segment *segment)
{
    proto_write_object_begin(writer);
    proto_member_array(writer, "control_points");
    for (int k = 0; k < 4; k++) proto_point_encode(writer, mesh, &segment->control[k], NAN);
    proto_write_array_end(writer);
    proto_member_number(writer, "distance", segment->distance);
    proto_member_bool(writer, "clipped", segment->is_clipped);
    proto_member_bool(writer, "cut_locus", segment->is_cut);
    proto_write_object_end(writer);
}

void proto_spline_joint_encode_tangent(struct proto_writer *writer,
                                       const struct gd_spline_knot *knot)
{
    proto_vector_encode(writer, knot->tangent.length > 0 ? &knot->tangent.direction : NULL,
                        knot->tangent.length);
}

static void encode_frame(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_spline_place *place)
{
    const struct proto_spline_frame frame = {gd_frame_at(mesh, place), place->speed};
    proto_spline_frame_encode(writer, &frame);
}

void proto_spline_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_spline *spline, const struct gd_spline_line *line,
                         bool frames, const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (proto_field(writer, options, PROTO_SPLINE_FIELD_PATH))
        proto_path_encode(writer, mesh, &line->path, options->geometry);
    if (proto_field(writer, options, PROTO_SPLINE_FIELD_SEGMENTS)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < spline->count; i++)
            encode_segment(writer, mesh, &spline->segments[i]);
        proto_write_array_end(writer);
    }
    if (proto_field(writer, options, PROTO_SPLINE_FIELD_PARAMETERS)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i <= spline->count; i++)
            proto_write_number(writer, spline->knots[i].parameter);
        proto_write_array_end(writer);
    }
    if (proto_field(writer, options, PROTO_SPLINE_FIELD_JOINTS)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < spline->count + !spline->closed; i++)
            proto_spline_joint_encode(writer, &spline->knots[i]);
        proto_write_array_end(writer);
    }
    if (frames && proto_field(writer, options, PROTO_SPLINE_FIELD_FRAMES)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < line->count; i++) encode_frame(writer, mesh, &line->places[i]);
        proto_write_array_end(writer);
    }
    if (line->step > 0) proto_field_number(writer, options, PROTO_SPLINE_FIELD_STEP, line->step);
    proto_write_object_end(writer);
}
