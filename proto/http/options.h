/* Options: the query string and the parameters that all queries share: select, geometry,
 * timeout_ms. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "generated/fields.h"
#include "generated/parameters.h"
#include "proto/json/object.h"

/* The parameters of a decoded query string; borrowed. */
struct proto_parameters {
    const struct proto_parameter {
        const char *name, *value; /* the value "" means a parameter without a value */
    } * all;
    uint32_t count;
};

/* Returns the value of the first parameter of that name, or NULL. */
const char *proto_parameters_get(const struct proto_parameters *parameters, const char *name);

/* Checks that each parameter's name is in `allowed` (NULL-terminated, at most 32; NULL means that
 * no name is allowed) and occurs once. Otherwise fails with invalid_request at the parameter. */
bool proto_parameters_check(const struct proto_parameters *parameters, const char *const *allowed,
                            struct proto_problem *problem);

/* Returns the value of a required parameter. If it is missing or empty, returns NULL with the
 * problem invalid_request. The value lives as long as the query string. */
const char *proto_parameters_require(const struct proto_parameters *parameters, const char *name,
                                     struct proto_problem *problem);

/* Reads a decimal integer in [least, most]; `*out` is untouched when the parameter is absent. */
bool proto_parameters_integer(const struct proto_parameters *parameters, const char *name,
                              uint64_t least, uint64_t most, uint64_t *out,
                              struct proto_problem *problem);

/* Reads one of `words` (NULL-terminated) as its index; `*out` is untouched when the parameter is
 * absent. */
bool proto_parameters_choice(const struct proto_parameters *parameters, const char *name,
                             const char *const *words, unsigned *out,
                             struct proto_problem *problem);

/* Reads "true" or "false"; `*out` is untouched when the parameter is absent. */
bool proto_parameters_flag(const struct proto_parameters *parameters, const char *name, bool *out,
                           struct proto_problem *problem);

/* Reads a number within the rule's limits; the rule has the parameter's name. `*out` is untouched
 * when the parameter is absent. */
bool proto_parameters_number(const struct proto_parameters *parameters,
                             const struct proto_rule *rule, double *out,
                             struct proto_problem *problem);

struct proto_options {
    uint32_t fields; /* bit i: the i-th field of the answer is wanted; all of them by default */
    const char *const *names; /* names of the fields */
    enum proto_geometry geometry;
    uint64_t timeout_ms; /* 0 if not given; the configured maximum is not applied yet */
};

struct proto_writer;

/* If the field (one bit) is selected, writes its key and returns true; the caller then writes the
 * value. Otherwise returns false. */
bool proto_field(struct proto_writer *writer, const struct proto_options *options, uint32_t field);

/* Writes the field with its value if it is selected. A number that is not finite becomes null. */
void proto_field_number(struct proto_writer *writer, const struct proto_options *options,
                        uint32_t field, double value);
void proto_field_uint(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, uint64_t value);
void proto_field_bool(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, bool value);

/* Returns the selected bits among `members`, which are the parts of the field `whole`. Returns all
 * of them if only `whole` is selected, and 0 if neither `whole` nor a part is selected. */
uint32_t proto_fields_within(uint32_t fields, uint32_t whole, uint32_t members);

/* Returns the options for a part of the answer, the field `whole`, whose members are all other
 * fields. */
struct proto_options proto_options_within(const struct proto_options *options, uint32_t whole);

/* Reads the options that all queries share: select, geometry and timeout_ms. `allowed` are the
 * names of the operation's parameters. `fields` are the names of the answer's top-level fields;
 * NULL means that fields can't be selected. Both lists end with NULL and have at most 32 names.
 * Fails with invalid_request at the parameter. */
bool proto_options_parse(const struct proto_parameters *parameters, const char *const *fields,
                         const char *const *allowed, struct proto_options *out,
                         struct proto_problem *problem);

/* Steps of proto_options_parse. proto_options_of returns the default options, which select all
 * fields. proto_options_select reads the texts of the parameters `select` and `geometry`, which are
 * NULL if not given. Its problems refer to these parameters. proto_options_timeout reads
 * timeout_ms. */
struct proto_options proto_options_of(const char *const *fields);
bool proto_options_select(struct proto_options *options, const char *select, const char *geometry,
                          struct proto_problem *problem);
bool proto_options_timeout(const struct proto_parameters *parameters, struct proto_options *out,
                           struct proto_problem *problem);

/* Fills in the problem that a geometry other than full is requested for an answer without lines.
 * Returns false. */
bool proto_options_refuse_geometry(struct proto_problem *problem, const char *place);
