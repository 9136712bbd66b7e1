#include "proto/json/problem.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "proto/json/writer.h"

/* --- the list --------------------------------------------------------------------------------- */

static const struct {
    unsigned status; /* HTTP status */
    const char *name, *title;
} codes[] = {[PROTO_PROBLEM_NONE] = {200, "none", "No problem"},
#define PROTO_PROBLEM_ROW(status, NAME, name, title)                                               \
    [PROTO_PROBLEM_##NAME] = {status, #name, title},
             PROTO_PROBLEM_MAP(PROTO_PROBLEM_ROW)
#undef PROTO_PROBLEM_ROW
};

const char *proto_problem_name(enum proto_problem_code code)
{
    return codes[code].name;
}

/* --- making one ------------------------------------------------------------------------------- */

static void start(struct proto_problem *problem, enum proto_problem_code code, const char *format,
                  va_list arguments)
{
    memset(problem, 0, sizeof *problem);
    problem->code = code;
    problem->status = codes[code].status;
    vsnprintf(problem->detail, sizeof problem->detail, format, arguments);
}

bool proto_problem_set(struct proto_problem *problem, enum proto_problem_code code,
                       const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    start(problem, code, format, arguments);
    va_end(arguments);
    return false;
}

bool proto_problem_refuse(struct proto_problem *problem, const char *place, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    start(problem, PROTO_PROBLEM_INVALID_REQUEST, format, arguments);
    va_end(arguments);
    return proto_problem_at(problem, place);
}

bool proto_problem_refuse_member(struct proto_problem *problem, const char *place,
                                 const char *member, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    start(problem, PROTO_PROBLEM_INVALID_REQUEST, format, arguments);
    va_end(arguments);
    proto_problem_at(problem, place);
    return proto_problem_descend(problem, member);
}

bool proto_problem_exceed(struct proto_problem *problem, const char *place, uint64_t limit,
                          const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    start(problem, PROTO_PROBLEM_TOO_LARGE, format, arguments);
    va_end(arguments);
    if (place) proto_problem_at(problem, place);
    return proto_problem_limit(problem, limit);
}

bool proto_problem_at(struct proto_problem *problem, const char *place)
{
    problem->has_pointer = place[0] == '\0' || place[0] == '/';
    char *to = problem->has_pointer ? problem->pointer : problem->parameter;
    size_t size = problem->has_pointer ? sizeof problem->pointer : sizeof problem->parameter;
    snprintf(to, size, "%s", place);
    return false;
}

bool proto_problem_descend(struct proto_problem *problem, const char *member)
{
    if (!problem->has_pointer) return false;
    size_t at = strlen(problem->pointer);
    const size_t last = sizeof problem->pointer - 3; /* room for an escape and the NUL */
    if (at < last) problem->pointer[at++] = '/';
    for (; *member && at < last; member++) {
        bool escaped = *member == '~' || *member == '/';
        if (escaped) problem->pointer[at++] = '~';
        problem->pointer[at++] = *member == '~' ? '0' : *member == '/' ? '1' : *member;
    }
    problem->pointer[at] = '\0';
    return false;
}

bool proto_problem_limit(struct proto_problem *problem, uint64_t limit)
{
    problem->has_limit = true;
    problem->limit = limit;
    return false;
}

/* --- from the engine -------------------------------------------------------------------------- */

static enum proto_problem_code code_of(enum gd_status status)
{
    switch (status) {
    case GD_INVALID_ARGUMENT:
    case GD_OUT_OF_RANGE:
    case GD_UNREFERENCED_VERTEX:
    case GD_NO_SUCH_EDGE:
        return PROTO_PROBLEM_INVALID_REQUEST;
    case GD_NOT_ON_SURFACE:
        return PROTO_PROBLEM_POINT_NOT_ON_SURFACE;
    case GD_UNRECOGNIZED:
    case GD_TRUNCATED:
    case GD_SYNTAX:
    case GD_UNSUPPORTED:
    case GD_INDEX:
    case GD_EMPTY:
    case GD_NON_FINITE:
    case GD_EXTENT:
    case GD_DEGENERATE_FACE:
    case GD_DUPLICATE_FACE:
    case GD_NON_MANIFOLD_EDGE:
    case GD_NON_MANIFOLD_VERTEX:
    case GD_NON_ORIENTABLE:
    case GD_NOT_TRIANGLES:
    case GD_NOT_TRIANGULABLE:
        return PROTO_PROBLEM_INVALID_MESH;
    case GD_NO_MEMORY:
    case GD_BUDGET:
        return PROTO_PROBLEM_INSUFFICIENT_MEMORY;
    case GD_TOO_LARGE:
        return PROTO_PROBLEM_TOO_LARGE;
    case GD_CANCELLED:
        return PROTO_PROBLEM_DRAINING;
    case GD_DEADLINE:
        return PROTO_PROBLEM_DEADLINE_EXCEEDED;
    case GD_OK:
    case GD_BEYOND_REACH:
    case GD_INTERNAL:
    case GD_RUNAWAY:
        break;
    }
    return PROTO_PROBLEM_INTERNAL;
}

static bool set_internal(struct proto_problem *problem, enum gd_status status)
{
    return proto_problem_set(
        problem, PROTO_PROBLEM_INTERNAL,
        status == GD_RUNAWAY
            ? "%s; please report it with the request"
            : "%s and the answer was withheld: the mesh may have faces that are smaller or thinner "
              "than "
              "rounding; upload it with ?weld=TOLERANCE to join them, or report the request",
        gd_status_sentence(status));
}

bool proto_problem_from_status(struct proto_problem *problem, enum gd_status status,
                               const struct gd_detail *detail)
{
    enum proto_problem_code code = code_of(status);
    if (code == PROTO_PROBLEM_INTERNAL) return set_internal(problem, status);
    if (code == PROTO_PROBLEM_DEADLINE_EXCEEDED)
        return proto_problem_set(problem, code,
                                 "%s; request less, or raise timeout_ms, at most to the daemon's "
                                 "--timeout-ms",
                                 gd_status_sentence(status));
    const char *sentence = detail && detail->text[0] ? detail->text : gd_status_sentence(status);
    proto_problem_set(problem, code, "%s", sentence);
    if (code == PROTO_PROBLEM_INVALID_MESH) problem->reason = gd_status_name(status);
    if (code == PROTO_PROBLEM_DRAINING) problem->retry_after = 1;
    if (detail && detail->kind != GD_ELEMENT_NONE) {
        problem->element = detail->kind;
        problem->element_count = detail->count;
        memcpy(problem->elements, detail->elements, sizeof problem->elements);
    }
    return false;
}

/* --- to JSON ---------------------------------------------------------------------------------- */

static const char *const element_names[] = {
    [GD_ELEMENT_NONE] = "element", [GD_ELEMENT_VERTEX] = "vertex", [GD_ELEMENT_EDGE] = "edge",
    [GD_ELEMENT_FACE] = "face",    [GD_ELEMENT_LINE] = "line",     [GD_ELEMENT_BYTE] = "byte"};

static void encode_element(struct proto_writer *writer, enum gd_element element,
                           const uint64_t id[2])
{
    proto_write_object_begin(writer);
    proto_write_key(writer, element_names[element]);
    if (element == GD_ELEMENT_EDGE)
        proto_write_indices(writer, (const uint32_t[]){(uint32_t)id[0], (uint32_t)id[1]}, 2);
    else
        proto_write_uint(writer, id[0]);
    proto_write_object_end(writer);
}

static void encode_elements(struct proto_writer *writer, const struct proto_problem *problem)
{
    proto_member_array(writer, "elements");
    for (uint32_t i = 0; i < problem->element_count; i++)
        encode_element(writer, problem->element, problem->elements[i]);
    proto_write_array_end(writer);
}

void proto_problem_encode(struct proto_writer *writer, const struct proto_problem *problem)
{
    char type[64];
    snprintf(type, sizeof type, "urn:geodesicd:problem:%s", codes[problem->code].name);
    proto_write_object_begin(writer);
    proto_member_string(writer, "type", type);
    proto_member_string(writer, "title", codes[problem->code].title);
    proto_member_uint(writer, "status", problem->status);
    proto_member_string(writer, "detail", problem->detail);
    proto_member_string(writer, "code", codes[problem->code].name);
    if (problem->has_pointer) proto_member_string(writer, "pointer", problem->pointer);
    if (problem->parameter[0]) proto_member_string(writer, "parameter", problem->parameter);
    if (problem->reason) proto_member_string(writer, "reason", problem->reason);
    if (problem->has_limit) proto_member_uint(writer, "limit", problem->limit);
    if (problem->element_count) encode_elements(writer, problem);
    proto_write_object_end(writer);
}

bool proto_writer_check(const struct proto_writer *writer, struct proto_problem *problem)
{
    switch (writer->failure) {
    case PROTO_WRITER_FINE:
        return true;
    case PROTO_WRITER_NO_MEMORY:
        return proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                                 "there is no memory for the answer; try again later");
    case PROTO_WRITER_NO_ROOM:
        proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                          "answers that other clients have not read to the end hold the "
                          "memory that this one needs; try again in a moment");
        problem->retry_after = 1;
        return false;
    case PROTO_WRITER_STOPPED:
        return proto_problem_from_status(problem, GD_CANCELLED, NULL);
    case PROTO_WRITER_TOO_LARGE:
        break;
    }
    proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                      "the answer is larger than the limit of %zu bytes; ask for less of it, "
                      "with select, geometry or fewer points, or have the operator raise "
                      "--max-answer or --memory-budget",
                      writer->maximum);
    return proto_problem_limit(problem, writer->maximum);
}
