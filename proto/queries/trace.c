#include "proto/queries/trace.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"
#include "proto/values/path.h"

const char *const proto_trace_fields[] = {"start", "paths", NULL};

void proto_trace_free(struct proto_trace *trace)
{
    free(trace->directions);
    *trace = (struct proto_trace){0};
}

/* --- directions ------------------------------------------------------------------------------- */

static bool check_count(double count, const char *place, struct proto_problem *problem)
{
    if (count < 1) return proto_problem_refuse(problem, place, "ask for at least one direction");
    if (count <= PROTO_TRACE_DIRECTIONS) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "at most %d directions are traced at once; ask for fewer",
                      PROTO_TRACE_DIRECTIONS);
    proto_problem_at(problem, place);
    return proto_problem_limit(problem, PROTO_TRACE_DIRECTIONS);
}

static bool decode_directions(const json_t *value, struct proto_trace *trace,
                              struct proto_problem *problem)
{
    if (!json_is_array(value))
        return proto_problem_refuse(problem, "/directions", "expected an array of directions here");
    if (!check_count((double)json_array_size(value), "/directions", problem)) return false;
    trace->count = (uint32_t)json_array_size(value);
    trace->directions = malloc(trace->count * sizeof *trace->directions);
    if (!trace->directions) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < trace->count; i++) {
        char place[PROTO_DIRECTION_PLACE];
        snprintf(place, sizeof place, "/directions/%u", i);
        if (!proto_direction_decode(json_array_get(value, i), place, &trace->directions[i],
                                    problem))
            return false;
    }
    return true;
}

static bool decode_fan(const json_t *document, struct proto_trace *trace,
                       struct proto_problem *problem)
{
    return proto_decode_index(document, "", "fan", &trace->count, problem) &&
           check_count(trace->count, "/fan", problem);
}

bool proto_trace_ways_decode(const json_t *document, struct proto_trace *trace,
                             struct proto_problem *problem)
{
    const json_t *directions = json_object_get(document, "directions");
    if (!directions == !json_object_get(document, "fan"))
        return proto_problem_refuse(
            problem, "", "say either directions or fan, the number of directions all around");
    return directions ? decode_directions(directions, trace, problem)
                      : decode_fan(document, trace, problem);
}

/* --- rules ------------------------------------------------------------------------------------ */

/* One of two words: 0 for the first, which is the default. */
static bool decode_word(const json_t *document, const char *member, const char *const words[2],
                        int *out, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, member);
    *out = 0;
    if (!value) return true;
    for (int i = 0; i < 2; i++) {
        *out = i;
        if (json_is_string(value) && strcmp(json_string_value(value), words[i]) == 0) return true;
    }
    proto_problem_refuse(problem, "", "%s is \"%s\" or \"%s\"", member, words[0], words[1]);
    return proto_problem_descend(problem, member);
}

bool proto_trace_vertex_rule_decode(const json_t *document, enum gd_vertex_rule usual,
                                    enum gd_vertex_rule *out, struct proto_problem *problem)
{
    static const char *const rules[2] = {"bisect", "limit_normal"};
    int rule;
    if (!decode_word(document, "vertex_rule", rules, &rule, problem)) return false;
    *out = rule ? GD_VERTEX_RULE_NORMAL : GD_VERTEX_RULE_BISECT;
    if (!json_object_get(document, "vertex_rule")) *out = usual;
    return true;
}

static bool decode_limit(const json_t *document, uint64_t *out, struct proto_problem *problem)
{
    uint32_t limit = PROTO_TRACE_STEPS;
    if (json_object_get(document, "step_limit") &&
        !proto_decode_index(document, "", "step_limit", &limit, problem))
        return false;
    *out = limit;
    if (limit >= 1 && limit <= GD_TRACE_STEPS) return true;
    return proto_problem_refuse(problem, "/step_limit",
                                "step_limit is a number of points from 1 to %d", GD_TRACE_STEPS);
}

static bool decode_rules(const json_t *document, struct gd_trace_options *out,
                         struct proto_problem *problem)
{
    static const char *const boundary_rules[2] = {"stop", "slide"};
    int boundary_rule;
    if (!proto_trace_vertex_rule_decode(document, GD_VERTEX_RULE_BISECT, &out->vertex_rule,
                                        problem) ||
        !decode_word(document, "boundary_rule", boundary_rules, &boundary_rule, problem))
        return false;
    out->boundary_rule = boundary_rule ? GD_BOUNDARY_RULE_SLIDE : GD_BOUNDARY_RULE_STOP;
    return proto_decode_flag(document, "", "stop_at_self_intersection",
                             &out->stop_at_self_intersection, problem) &&
           decode_limit(document, &out->step_limit, problem);
}

/* --- the request ------------------------------------------------------------------------------ */

static bool decode(const json_t *document, struct proto_trace *trace, struct proto_problem *problem)
{
    const json_t *start = proto_decode_member(document, "", "start", problem);
    if (!start || !proto_point_decode(start, "/start", &trace->start, problem)) return false;
    if (!proto_decode_number(document, "", "length", &trace->length, problem)) return false;
    if (!(trace->length >= 0))
        return proto_problem_refuse(problem, "/length", "a length is 0 or more");
    return decode_rules(document, &trace->options, problem) &&
           proto_trace_ways_decode(document, trace, problem);
}

bool proto_trace_decode(const json_t *document, struct proto_trace *out,
                        struct proto_problem *problem)
{
    static const char *const members[] = {"start",
                                          "directions",
                                          "fan",
                                          "length",
                                          "vertex_rule",
                                          "boundary_rule",
                                          "stop_at_self_intersection",
                                          "step_limit",
                                          NULL};
    struct proto_trace trace = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (decode(document, &trace, problem)) {
        *out = trace;
        return true;
    }
    proto_trace_free(&trace);
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

const char *proto_trace_end_name(enum gd_trace_end end)
{
    switch (end) {
    case GD_TRACE_END_BOUNDARY:
        return "boundary";
    case GD_TRACE_END_SELF_INTERSECTION:
        return "self_intersection";
    case GD_TRACE_END_STEP_LIMIT:
        return "step_limit";
    case GD_TRACE_END_LENGTH:
        break;
    }
    return "length";
}

void proto_trace_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_trace *trace, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", trace->path.length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < trace->path.count; i++)
            proto_path_point_encode(writer, mesh, &trace->path.points[i], geometry);
        proto_write_array_end(writer);
    }
    proto_write_key(writer, "end_direction");
    proto_direction_encode(writer, &trace->direction);
    proto_member_string(writer, "end_reason", proto_trace_end_name(trace->end));
    proto_write_object_end(writer);
}
