#include "proto/queries/isoline.h"

#include <math.h>
#include <stdlib.h>

#include "gd/direction.h"
#include "generated/queries.h"
#include "generated/requests.h"
#include "proto/json/number.h"
#include "proto/values/point.h"

#define TOLERANCE_OF_DIAGONAL (1.0 / 2000)

void proto_isolines_free(struct proto_isolines *isolines)
{
    free(isolines->levels);
    *isolines = (struct proto_isolines){0};
}

/* --- levels ----------------------------------------------------------------------------------- */

static bool refuse_memory(struct proto_problem *problem)
{
    return proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "there is no memory for the levels; try again later");
}

static bool check_count(const char *place, uint64_t count, struct proto_problem *problem)
{
    if (count == 0) return proto_problem_refuse(problem, place, "ask for at least one level");
    if (count <= PROTO_ISOLINES_LEVELS) return true;
    return proto_problem_exceed(problem, place, PROTO_ISOLINES_LEVELS,
                                "at most %d levels are taken here; ask for fewer",
                                PROTO_ISOLINES_LEVELS);
}

static bool check_levels(const struct proto_isolines *isolines, struct proto_problem *problem)
{
    for (uint32_t i = 0; i < isolines->level_count; i++)
        if (!(isolines->levels[i] >= 0))
            return proto_problem_refuse(problem, isolines->place,
                                        "a level is a distance: a number of at least 0");
    return true;
}

/* --- from the body ---------------------------------------------------------------------------- */

bool proto_isolines_decode(const json_t *document, struct proto_isolines *out,
                           struct proto_problem *problem)
{
    struct proto_isolines_request request;
    if (!proto_isolines_request_decode(document, &request, problem)) return false;
    struct proto_isolines isolines = {.levels = request.levels.items,
                                      .level_count =
                                          request.has_count ? request.count : request.levels.count,
                                      .tolerance = request.tolerance,
                                      .wants_arcs = request.arcs,
                                      .place = request.has_count ? "/count" : "/levels"};
    if (isolines.levels && !check_levels(&isolines, problem)) {
        proto_isolines_free(&isolines);
        return false;
    }
    *out = isolines;
    return true;
}

/* --- from the query string -------------------------------------------------------------------- */

static bool parse_levels(const char *text, struct proto_isolines *out,
                         struct proto_problem *problem)
{
    uint64_t count = 1;
    out->place = "levels";
    for (const char *c = text; *c; c++) count += *c == ',';
    if (!check_count(out->place, count, problem)) return false;
    out->levels = malloc(count * sizeof *out->levels);
    if (!out->levels) return refuse_memory(problem);
    for (; out->level_count < count; text++) {
        size_t length = proto_number_parse(text, &out->levels[out->level_count++]);
        text += length;
        if (length == 0 || *text != (out->level_count < count ? ',' : '\0'))
            return proto_problem_refuse(problem, out->place,
                                        "expected numbers with commas between them: 0.5,1");
    }
    return check_levels(out, problem);
}

static bool parse(const struct proto_parameters *parameters, struct proto_isolines *out,
                  struct proto_problem *problem)
{
    struct proto_get_isolines_query query;
    bool has_count = proto_parameters_get(parameters, "count") != NULL;
    if ((proto_parameters_get(parameters, "levels") != NULL) == has_count)
        return proto_problem_refuse(problem, "levels",
                                    "say which levels, or count, how many of them: one of both");
    if (!proto_get_isolines_query_parse(parameters, &query, problem)) return false;
    out->tolerance = query.has_tolerance ? query.tolerance : 0;
    out->wants_arcs = query.arcs;
    if (!has_count) return parse_levels(query.levels, out, problem);
    out->place = "count";
    out->level_count = (uint32_t)query.count;
    return check_count(out->place, query.count, problem);
}

bool proto_isolines_parse(const struct proto_parameters *parameters, struct proto_isolines *out,
                          struct proto_problem *problem)
{
    struct proto_isolines isolines = {0};
    if (!parse(parameters, &isolines, problem)) {
        proto_isolines_free(&isolines);
        return false;
    }
    *out = isolines;
    return true;
}

/* --- on the field ----------------------------------------------------------------------------- */

static bool spread_levels(struct proto_isolines *isolines, double most,
                          struct proto_problem *problem)
{
    isolines->levels = malloc(isolines->level_count * sizeof *isolines->levels);
    if (!isolines->levels) return refuse_memory(problem);
    for (uint32_t i = 0; i < isolines->level_count; i++)
        isolines->levels[i] = most * (i + 1) / (isolines->level_count + 1);
    return true;
}

bool proto_isolines_settle(struct proto_isolines *isolines,
                           const struct proto_field_description *field,
                           struct proto_problem *problem)
{
    double reach = field->max_distance > 0 ? field->max_distance : INFINITY;
    if (!isolines->levels)
        return spread_levels(isolines, isnan(field->max) ? reach : field->max, problem);
    for (uint32_t i = 0; i < isolines->level_count; i++)
        if (isolines->levels[i] > reach)
            return proto_problem_refuse(
                problem, isolines->place,
                "the level %.17g is beyond the field's max_distance, %.17g, where it ends; ask "
                "for lower ones, or for a field that goes farther",
                isolines->levels[i], reach);
    return true;
}

double proto_isolines_tolerance(double tolerance, const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    return tolerance > 0 ? tolerance
                         : TOLERANCE_OF_DIAGONAL * gd_vec3_distance(summary->min, summary->max);
}

/* --- the answer ------------------------------------------------------------------------------- */

/* Converts the arc's start angle from the arc's own axes to those of directions. The result is in
 * [0, 2 pi), and never -0. */
static double start_of(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc)
{
    struct gd_vec3 zero, quarter, x, y;
    gd_isoline_arc_axes(mesh, arc, &x, &y);
    gd_direction_axes(mesh, arc->face, &zero, &quarter);
    double start =
        fmod(arc->from + atan2(gd_vec3_dot(x, quarter), gd_vec3_dot(x, zero)), 2 * M_PI) + 0.0;
    if (start < 0) start += 2 * M_PI;
    return start < 2 * M_PI ? start : 0;
}

static void write_round(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_isoline_arc *arc)
{
    double start = start_of(mesh, arc);
    proto_member_xyz(writer, "centre", arc->centre);
    proto_member_number(writer, "radius", arc->radius);
    proto_member_number(writer, "start", start);
    proto_member_number(writer, "end", start + (arc->to - arc->from));
}

void proto_arc_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                      const struct gd_isoline_arc *arc)
{
    proto_write_object_begin(writer);
    proto_member_uint(writer, "face", arc->face.index);
    if (arc->radius > 0) {
        write_round(writer, mesh, arc);
    } else {
        proto_member_bool(writer, "straight", true);
    }
    proto_write_object_end(writer);
}
