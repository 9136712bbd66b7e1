#include "proto/http/options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "proto/json/number.h"
#include "proto/json/writer.h"

#define MOST_NAMES 32 /* an answer's fields or an operation's parameters; each is one bit */

/* Returns the index of the name, which has `size` bytes, or MOST_NAMES if the name is not
 * listed. */
static unsigned find_name(const char *const *names, const char *name, size_t size)
{
    for (unsigned i = 0; names && names[i]; i++) {
        if (*names[i] == *name && strncmp(names[i], name, size) == 0 && names[i][size] == '\0')
            return i;
    }
    return MOST_NAMES;
}

/* --- any query string ------------------------------------------------------------------------- */

const char *proto_parameters_get(const struct proto_parameters *parameters, const char *name)
{
    for (uint32_t i = 0; i < parameters->count; i++) {
        const struct proto_parameter *parameter = &parameters->all[i];
        if (*parameter->name == *name && strcmp(parameter->name, name) == 0)
            return parameter->value;
    }
    return NULL;
}

/* Fills in a problem at a parameter. An unknown name may look like a JSON Pointer, which
 * proto_problem_at would misread. */
static bool refuse_name(struct proto_problem *problem, const char *name, const char *why)
{
    proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST, "the parameter \"%.64s\" %s", name,
                      why);
    snprintf(problem->parameter, sizeof problem->parameter, "%s", name);
    return false;
}

bool proto_parameters_check(const struct proto_parameters *parameters, const char *const *allowed,
                            struct proto_problem *problem)
{
    uint32_t seen = 0;
    for (uint32_t i = 0; i < parameters->count; i++) {
        const char *name = parameters->all[i].name;
        unsigned number = find_name(allowed, name, strlen(name));
        if (number == MOST_NAMES)
            return refuse_name(problem, name,
                               "is unknown here; check its spelling or leave it out");
        if (seen >> number & 1) return refuse_name(problem, name, "stands more than once");
        seen |= UINT32_C(1) << number;
    }
    return true;
}

const char *proto_parameters_require(const struct proto_parameters *parameters, const char *name,
                                     struct proto_problem *problem)
{
    const char *value = proto_parameters_get(parameters, name);
    if (value && *value) return value;
    proto_problem_refuse(problem, name, "the parameter \"%s\" is missing", name);
    return NULL;
}

bool proto_parameters_integer(const struct proto_parameters *parameters, const char *name,
                              uint64_t least, uint64_t most, uint64_t *out,
                              struct proto_problem *problem)
{
    const char *text = proto_parameters_get(parameters, name);
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

static bool find_word(const char *text, const char *name, const char *const *words, unsigned *out,
                      struct proto_problem *problem)
{
    unsigned word = find_name(words, text, strlen(text));
    if (word != MOST_NAMES) {
        *out = word;
        return true;
    }
    proto_problem_refuse(problem, name, "expected one of:");
    append_words(problem, words);
    return false;
}

bool proto_parameters_choice(const struct proto_parameters *parameters, const char *name,
                             const char *const *words, unsigned *out, struct proto_problem *problem)
{
    const char *text = proto_parameters_get(parameters, name);
    return !text || find_word(text, name, words, out, problem);
}

bool proto_parameters_flag(const struct proto_parameters *parameters, const char *name, bool *out,
                           struct proto_problem *problem)
{
    static const char *const words[] = {"false", "true", NULL};
    unsigned word = *out;
    if (!proto_parameters_choice(parameters, name, words, &word, problem)) return false;
    *out = word;
    return true;
}

bool proto_parameters_number(const struct proto_parameters *parameters,
                             const struct proto_rule *rule, double *out,
                             struct proto_problem *problem)
{
    const char *text = proto_parameters_get(parameters, rule->name);
    if (!text) return true;
    size_t length = proto_number_parse(text, out);
    bool is_number = length > 0 && text[length] == '\0';
    return proto_rule_check(rule, is_number ? *out : NAN, rule->name, problem);
}

/* --- the options of every query --------------------------------------------------------------- */

/* one day, so that the sum of clock and timeout can't overflow */
#define MOST_TIMEOUT_MS UINT64_C(86400000)

static bool refuse_member(struct proto_problem *problem, const char *name, int size,
                          const char *const *names)
{
    proto_problem_refuse(problem, "select", "the answer has no member \"%.*s\"; it has", size,
                         name);
    append_words(problem, names);
    return false;
}

static bool parse_fields(const char *text, const char *const *names, uint32_t *out,
                         struct proto_problem *problem)
{
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

#define FIELD(kind, type)                                                                          \
    void proto_field_##kind(struct proto_writer *writer, const struct proto_options *options,      \
                            uint32_t field, type value)                                            \
    {                                                                                              \
        if (proto_field(writer, options, field)) proto_write_##kind(writer, value);                \
    }
FIELD(number, double)
FIELD(uint, uint64_t)
FIELD(bool, bool)
#undef FIELD

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

bool proto_options_select(struct proto_options *options, const char *select, const char *geometry,
                          struct proto_problem *problem)
{
    unsigned word = PROTO_GEOMETRY_FULL;
    if (select && options->names &&
        !parse_fields(select, options->names, &options->fields, problem))
        return false;
    if (geometry && !find_word(geometry, "geometry", proto_geometry_words, &word, problem))
        return false;
    options->geometry = (enum proto_geometry)word;
    return true;
}

struct proto_options proto_options_of(const char *const *fields)
{
    struct proto_options options = {.names = fields};
    for (unsigned i = 0; fields && fields[i]; i++) options.fields |= UINT32_C(1) << i;
    return options;
}

bool proto_options_timeout(const struct proto_parameters *parameters, struct proto_options *out,
                           struct proto_problem *problem)
{
    return proto_parameters_integer(parameters, "timeout_ms", 1, MOST_TIMEOUT_MS, &out->timeout_ms,
                                    problem);
}

bool proto_options_parse(const struct proto_parameters *parameters, const char *const *fields,
                         const char *const *allowed, struct proto_options *out,
                         struct proto_problem *problem)
{
    struct proto_options options = proto_options_of(fields);
    const char *select = proto_parameters_get(parameters, "select"),
               *geometry = proto_parameters_get(parameters, "geometry");
    if (!proto_parameters_check(parameters, allowed, problem) ||
        !proto_options_select(&options, select, geometry, problem) ||
        !proto_options_timeout(parameters, &options, problem))
        return false;
    *out = options;
    return true;
}

bool proto_options_refuse_geometry(struct proto_problem *problem, const char *place)
{
    return proto_problem_refuse(problem, place,
                                "the answer has no lines whose points could be left out or be "
                                "bare coordinates; leave geometry out, or send full");
}
