/* Options: the query string, and what every query takes from it: select, geometry, timeout_ms. */
#ifndef PROTO_OPTIONS_H
#define PROTO_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "generated/fields.h"
#include "generated/parameters.h"
#include "proto/json/problem.h"

/* A view of a decoded query string; its owner lends it for a call. Names and values are
 * NUL-terminated and percent-decoded. */
struct proto_parameters {
    /* Value of the first parameter of that name; "" for a parameter without a value; NULL when
     * there is none. */
    const char *(*get)(void *user, const char *name);
    /* Calls visit(context, name) once for each parameter, repeated ones included, until it returns
     * false. */
    void (*each)(void *user, bool (*visit)(void *context, const char *name), void *context);
    void *user;
};

/* Each parameter's name is one of `allowed` (NULL-terminated, at most 32 of them; NULL: none is)
 * and stands once; else invalid_request with the parameter. */
bool proto_parameters_check(const struct proto_parameters *parameters, const char *const *allowed,
                            struct proto_problem *problem);

/* Value of a parameter that must be there and not be empty; else NULL and invalid_request. Lives as
 * long as the query string. */
const char *proto_parameters_require(const struct proto_parameters *parameters, const char *name,
                                     struct proto_problem *problem);

/* A decimal integer in [least, most]; `*out` is untouched when the parameter is absent. */
bool proto_parameters_integer(const struct proto_parameters *parameters, const char *name,
                              uint64_t least, uint64_t most, uint64_t *out,
                              struct proto_problem *problem);

/* One word of `words` (NULL-terminated): `*out` is its number; untouched when the parameter is
 * absent. */
bool proto_parameters_choice(const struct proto_parameters *parameters, const char *name,
                             const char *const *words, unsigned *out,
                             struct proto_problem *problem);

struct proto_options {
    uint32_t fields; /* bit i: the i-th field of the answer is wanted; all of them by default */
    const char *const *names; /* of the fields */
    enum proto_geometry geometry;
    uint64_t timeout_ms; /* 0: not said; not yet capped */
};

struct proto_writer;

/* True if the field, one bit, is wanted: then its key is written, and the value is to follow. */
bool proto_field(struct proto_writer *writer, const struct proto_options *options, uint32_t field);

/* The same with a value. A number that is not finite is null. */
void proto_field_number(struct proto_writer *writer, const struct proto_options *options,
                        uint32_t field, double value);
void proto_field_uint(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, uint64_t value);
void proto_field_bool(struct proto_writer *writer, const struct proto_options *options,
                      uint32_t field, bool value);

/* Of the fields that are wanted, those of `members`, which are parts of the field `whole`: all of
 * them where it alone is named; 0: none is wanted. */
uint32_t proto_fields_within(uint32_t fields, uint32_t whole, uint32_t members);

/* The options for a part of the answer: all fields but `whole` are its members. */
struct proto_options proto_options_within(const struct proto_options *options, uint32_t whole);

/* Reads the options that all queries have in common: fields, geometry and timeout_ms. `allowed`: the
 * names of the operation's parameters. `fields`: those of the answer's top-level fields; NULL: there
 * is no projection. Both are NULL-terminated, with at most 32 names. invalid_request with the
 * parameter. */
bool proto_options_parse(const struct proto_parameters *parameters, const char *const *fields,
                         const char *const *allowed, struct proto_options *out,
                         struct proto_problem *problem);

#endif
