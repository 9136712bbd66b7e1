#include "proto/http/options.h"

#include <stdio.h>
#include <string.h>

#include "proto/json/number.h"
#include "proto/json/writer.h"

#define MOST_NAMES 32 /* fields of an answer, or parameters of an operation: one bit each */

/* Number of the name that is `size` bytes long, or MOST_NAMES when it is not among them. */
static unsigned find_name(const char *const *names, const char *name, size_t size)
{
    for (unsigned i = 0; names && names[i]; i++) {
        if (*names[i] == *name && strncmp(names[i], name, size) == 0 && names[i][size] == '\0')
            return i;
    }
    return MOST_NAMES;
}

/* --- any query string ------------------------------------------------------------------------- */

struct check {
    const char *const *allowed;
    uint32_t seen;
    bool passed;
    struct proto_problem *problem;
};

/* A name that the client made up may look like a JSON Pointer, so it does not go through
 * proto_problem_at. */
static bool refuse_name(struct check *check, const char *name, const char *why)
{
    struct proto_problem *problem = check->problem;
    proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST, "the parameter \"%.64s\" %s", name,
                      why);
    snprintf(problem->parameter, sizeof problem->parameter, "%s", name);
    return check->passed = false;
}

static bool check_name(void *context, const char *name)
{
    struct check *check = context;
    unsigned number = find_name(check->allowed, name, strlen(name));
    if (number == MOST_NAMES)
        return refuse_name(check, name, "is unknown here; check its spelling or leave it out");
    if (check->seen >> number & 1) return refuse_name(check, name, "stands more than once");
    check->seen |= UINT32_C(1) << number;
    return true;
}

bool proto_parameters_check(const struct proto_parameters *parameters, const char *const *allowed,
                            struct proto_problem *problem)
{
    struct check check = {.allowed = allowed, .passed = true, .problem = problem};
    parameters->each(parameters->user, check_name, &check);
    return check.passed;
}

const char *proto_parameters_require(const struct proto_parameters *parameters, const char *name,
                                     struct proto_problem *problem)
{
    const char *value = parameters->get(parameters->user, name);
    if (value && *value) return value;
    proto_problem_refuse(problem, name, "the parameter \"%s\" is missing", name);
    return NULL;
}

bool proto_parameters_integer(const struct proto_parameters *parameters, const char *name,
                              uint64_t least, uint64_t most, uint64_t *out,
                              struct proto_problem *problem)
{
    const char *text = parameters->get(parameters->user, name);
    if (!text) return true;
    uint64_t value;
    size_t length = proto_integer_parse(text, &value);
    if (length == 0 || text[length] != '\0' || value < least || value > most)
        return proto_problem_refuse(problem, name, "expected a whole number from %llu to %llu",
                                    (unsigned long long)least, (unsigned long long)most);
    *out = value;
    return true;
}

static void append_words(struct proto_problem *problem, const char *const *words)
{
    for (size_t at = strlen(problem->detail); *words; words++, at = strlen(problem->detail))
        snprintf(problem->detail + at, sizeof problem->detail - at, " %s", *words);
}

bool proto_parameters_choice(const struct proto_parameters *parameters, const char *name,
                             const char *const *words, unsigned *out, struct proto_problem *problem)
{
    const char *text = parameters->get(parameters->user, name);
    if (!text) return true;
    unsigned word = find_name(words, text, strlen(text));
    if (word != MOST_NAMES) {
        *out = word;
        return true;
    }
    proto_problem_refuse(problem, name, "expected one of:");
    append_words(problem, words);
    return false;
}

/* --- the options of every query --------------------------------------------------------------- */

/* a day: keeps the sum of clock and timeout far from overflow */
#define MOST_TIMEOUT_MS UINT64_C(86400000)

static bool refuse_member(struct proto_problem *problem, const char *name, int size,
                          const char *const *names)
{
    proto_problem_refuse(problem, "select", "the answer has no member \"%.*s\"; it has", size,
                         name);
    append_words(problem, names);
    return false;
}

static bool parse_fields(const struct proto_parameters *parameters, const char *const *names,
                         uint32_t *out, struct proto_problem *problem)
{
    const char *text = parameters->get(parameters->user, "select");
    if (!text) return true;
    uint32_t fields = 0;
    for (bool more = true; more;) {
        size_t size = strcspn(text, ",");
        unsigned number = find_name(names, text, size);
        if (number == MOST_NAMES)
            return refuse_member(problem, text, size < 64 ? (int)size : 64, names);
        fields |= UINT32_C(1) << number;
        more = text[size] == ',';
        text += size + 1;
    }
    *out = fields;
    return true;
}

bool proto_field(struct proto_writer *writer, const struct proto_options *options, uint32_t field)
{
    if (!(options->fields & field)) return false;
    proto_write_key(writer, options->names[__builtin_ctz(field)]);
    return true;
}

void proto_field_number(struct proto_writer *writer, const struct proto_options *options,
                        uint32_t field, double value)
{
    if (proto_field(writer, options, field)) proto_write_number(writer, value);
}

void proto_field_uint(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, uint64_t value)
{
    if (proto_field(writer, options, field)) proto_write_uint(writer, value);
}

void proto_field_bool(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, bool value)
{
    if (proto_field(writer, options, field)) proto_write_bool(writer, value);
}

uint32_t proto_fields_within(uint32_t fields, uint32_t whole, uint32_t members)
{
    uint32_t named = fields & members;
    return !named && fields & whole ? members : named;
}

struct proto_options proto_options_within(const struct proto_options *options, uint32_t whole)
{
    struct proto_options within = *options;
    within.fields = proto_fields_within(options->fields, whole, ~whole);
    return within;
}

static bool parse_geometry(const struct proto_parameters *parameters, enum proto_geometry *out,
                           struct proto_problem *problem)
{
    unsigned word = PROTO_GEOMETRY_FULL;
    if (!proto_parameters_choice(parameters, "geometry", proto_geometry_words, &word, problem))
        return false;
    *out = (enum proto_geometry)word;
    return true;
}

bool proto_options_parse(const struct proto_parameters *parameters, const char *const *fields,
                         const char *const *allowed, struct proto_options *out,
                         struct proto_problem *problem)
{
    struct proto_options options = {.geometry = PROTO_GEOMETRY_FULL, .names = fields};
    for (unsigned i = 0; fields && fields[i]; i++) options.fields |= UINT32_C(1) << i;
    if (!proto_parameters_check(parameters, allowed, problem)) return false;
    if (fields && !parse_fields(parameters, fields, &options.fields, problem)) return false;
    if (!parse_geometry(parameters, &options.geometry, problem)) return false;
    if (!proto_parameters_integer(parameters, "timeout_ms", 1, MOST_TIMEOUT_MS, &options.timeout_ms,
                                  problem))
        return false;
    *out = options;
    return true;
}
