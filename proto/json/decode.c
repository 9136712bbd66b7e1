#include "proto/json/decode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- the document ----------------------------------------------------------------------------- */

static void refuse_text(const struct proto_parse_end *end, struct proto_problem *problem)
{
    char line[24] = ""; /* line 1 is not named, because the text may be a line of a batch */
    if (end->deep_at) {
        proto_problem_refuse(problem, "", "the JSON is nested deeper than %d levels at byte %zu",
                             PROTO_DECODE_DEPTH, end->deep_at - 1);
        proto_problem_limit(problem, PROTO_DECODE_DEPTH);
        return;
    }
    /* for this error, the parser's text names one of its flags */
    bool is_null = json_error_code(&end->error) == json_error_null_character;
    if (end->error.line > 1) snprintf(line, sizeof line, "line %d, ", end->error.line);
    proto_problem_refuse(problem, "",
                         "the body is not JSON that can be taken: %scolumn %d, byte %d: %s", line,
                         end->error.column, end->error.position,
                         is_null ? "a string holds \\u0000" : end->error.text);
}

/* Bytes that jansson uses for an empty object, for an empty array, for a value in an array
 * (including the memory into which it is decoded), and for a member's name and value. */
#define OBJECT_BYTES 256
#define ARRAY_BYTES  160
#define VALUE_BYTES  80
#define MEMBER_BYTES 136
#define COST_STEP    ((size_t)1 << 20) /* bytes of text between two checks of the control */

size_t proto_decode_cost(const void *bytes, size_t size, const struct gd_control *control)
{
    static const unsigned short costs[256] = {
        ['{'] = OBJECT_BYTES, ['['] = ARRAY_BYTES, [','] = VALUE_BYTES, [':'] = MEMBER_BYTES};
    const unsigned char *text = bytes;
    size_t cost = 2 * size;
    for (size_t begin = 0; begin < size; begin += COST_STEP) {
        size_t end = size - begin < COST_STEP ? size : begin + COST_STEP;
        for (size_t i = begin; i < end; i++) cost += costs[text[i]];
        if (end < size && gd_control_check(control, 0)) break;
    }
    return cost;
}

json_t *proto_decode_document_within(const void *bytes, size_t size,
                                     const struct gd_control *control,
                                     struct proto_problem *problem)
{
    struct proto_parse_end end;
    if (size == 0) {
        proto_problem_refuse(problem, "", "the body is empty; send a JSON object");
        return NULL;
    }
    json_t *document = proto_parse(bytes, size, control, &end);
    if (document) return document;
    if (end.status == GD_NO_MEMORY)
        proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                          "there is no memory for the request; try again later");
    else if (end.status)
        proto_problem_from_status(problem, end.status, NULL);
    else
        refuse_text(&end, problem);
    return NULL;
}

json_t *proto_decode_document(const void *bytes, size_t size, struct proto_problem *problem)
{
    return proto_decode_document_within(bytes, size, NULL, problem);
}

/* --- typed access ----------------------------------------------------------------------------- */

static const char *type_name(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "an array";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_TRUE:
    case JSON_FALSE:
        return "a boolean";
    case JSON_NULL:
        return "null";
    }
    return "a value";
}

static bool is_among(const char *name, const char *const *names)
{
    for (; *names; names++) {
        if (strcmp(name, *names) == 0) return true;
    }
    return false;
}

bool proto_decode_object(const json_t *value, const char *place, const char *const *members,
                         struct proto_problem *problem)
{
    if (!json_is_object(value))
        return proto_problem_refuse(problem, place, "expected an object here, not %s",
                                    type_name(value));
    const char *name;
    json_t *member;
    json_object_foreach((json_t *)value, name, member)
    {
        if (is_among(name, members)) continue;
        return proto_problem_refuse_member(
            problem, place, name,
            "the member \"%.64s\" is unknown here; check its spelling or leave it out", name);
    }
    return true;
}

/* Truncates the place, because a problem's pointer has no more room. */
void proto_place_of_member(char out[PROTO_PLACE], const char *place, const char *member)
{
    snprintf(out, PROTO_PLACE, "%.*s/%.64s", PROTO_PLACE - 66, place, member);
}

void proto_place_of_element(char out[PROTO_PLACE], const char *place, size_t index)
{
    snprintf(out, PROTO_PLACE, "%.*s/%zu", PROTO_PLACE - 24, place, index);
}

const json_t *proto_decode_member(const json_t *object, const char *place, const char *member,
                                  struct proto_problem *problem)
{
    const json_t *value = json_object_get(object, member);
    if (value) return value;
    proto_problem_refuse_member(problem, place, member, "the member \"%s\" is missing", member);
    return NULL;
}

enum scalar { SCALAR_NUMBER, SCALAR_INDEX };

/* Returns false with a problem that has no place yet. */
static bool check_scalar(const json_t *value, enum scalar scalar, struct proto_problem *problem)
{
    const char *expected =
        scalar == SCALAR_INDEX ? "a whole number from 0 to 4294967294" : "a number";
    if (!json_is_number(value))
        return proto_problem_refuse(problem, "", "expected %s, not %s", expected, type_name(value));
    double number = json_number_value(value);
    bool is_index = number >= 0 && number < (double)UINT32_MAX && number == floor(number);
    if (scalar == SCALAR_INDEX && !is_index)
        return proto_problem_refuse(problem, "", "expected %s", expected);
    return true;
}

static bool decode_scalar(const json_t *object, const char *place, const char *member,
                          enum scalar scalar, double *out, struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(object, place, member, problem);
    if (!value) return false;
    if (!check_scalar(value, scalar, problem)) {
        proto_problem_at(problem, place);
        return proto_problem_descend(problem, member);
    }
    *out = json_number_value(value);
    return true;
}

bool proto_decode_number(const json_t *object, const char *place, const char *member, double *out,
                         struct proto_problem *problem)
{
    return decode_scalar(object, place, member, SCALAR_NUMBER, out, problem);
}

bool proto_decode_index(const json_t *object, const char *place, const char *member, uint32_t *out,
                        struct proto_problem *problem)
{
    double number = 0;
    if (!decode_scalar(object, place, member, SCALAR_INDEX, &number, problem)) return false;
    *out = (uint32_t)number;
    return true;
}

bool proto_decode_flag(const json_t *object, const char *place, const char *member, bool *out,
                       struct proto_problem *problem)
{
    const json_t *value = json_object_get(object, member);
    if (value && !json_is_boolean(value))
        return proto_problem_refuse_member(problem, place, member, "expected true or false");
    *out = json_is_true(value);
    return true;
}

/* --- arrays ----------------------------------------------------------------------------------- */

/* Returns the member if it is an array of `count` such scalars, else NULL. */
static const json_t *decode_array(const json_t *object, const char *place, const char *member,
                                  size_t count, enum scalar scalar, struct proto_problem *problem)
{
    const json_t *array = proto_decode_member(object, place, member, problem);
    if (!array) return NULL;
    if (!json_is_array(array) || json_array_size(array) != count) {
        proto_problem_refuse_member(problem, place, member, "expected an array of %zu numbers",
                                    count);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        if (check_scalar(json_array_get(array, i), scalar, problem)) continue;
        char index[24];
        snprintf(index, sizeof index, "%zu", i);
        proto_problem_at(problem, place);
        proto_problem_descend(problem, member);
        proto_problem_descend(problem, index);
        return NULL;
    }
    return array;
}

bool proto_decode_numbers(const json_t *object, const char *place, const char *member, size_t count,
                          double *out, struct proto_problem *problem)
{
    const json_t *array = decode_array(object, place, member, count, SCALAR_NUMBER, problem);
    if (!array) return false;
    for (size_t i = 0; i < count; i++) out[i] = json_number_value(json_array_get(array, i));
    return true;
}

bool proto_decode_indices(const json_t *object, const char *place, const char *member, size_t count,
                          uint32_t *out, struct proto_problem *problem)
{
    const json_t *array = decode_array(object, place, member, count, SCALAR_INDEX, problem);
    if (!array) return false;
    for (size_t i = 0; i < count; i++)
        out[i] = (uint32_t)json_number_value(json_array_get(array, i));
    return true;
}

bool proto_read_numbers(const json_t *array, size_t count, double *out)
{
    for (size_t i = 0; i < count; i++) {
        const json_t *number = json_array_get(array, i);
        if (!json_is_number(number)) return false;
        out[i] = json_number_value(number);
    }
    return json_array_size(array) == count;
}

/* --- back to text ----------------------------------------------------------------------------- */

void proto_write_document(struct proto_writer *writer, const json_t *value)
{
    const char *key;
    json_t *member;
    if (json_is_object(value)) {
        proto_write_object_begin(writer);
        json_object_foreach((json_t *)value, key, member)
        {
            proto_write_string(writer, key);
            proto_append(writer, ":", 1);
            writer->comma = false;
            proto_write_document(writer, member);
        }
        proto_write_object_end(writer);
    } else if (json_is_array(value)) {
        proto_write_array_begin(writer);
        for (size_t i = 0; i < json_array_size(value); i++)
            proto_write_document(writer, json_array_get(value, i));
        proto_write_array_end(writer);
    } else if (json_is_number(value)) {
        proto_write_number(writer, json_number_value(value));
    } else if (json_is_boolean(value)) {
        proto_write_bool(writer, json_is_true(value));
    } else {
        /* a string; or null, for which json_string_value returns NULL */
        proto_write_string(writer, json_string_value(value));
    }
}
