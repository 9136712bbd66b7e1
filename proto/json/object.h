/* Object: an object of a request while it is decoded. The rules of its members are generated from
 * the contract (generated/requests.c).
 *
 * Each function that reads a member returns true, or false with a problem at the member. If an
 * optional member is missing, `*out` keeps its value. */
#pragma once

#include "proto/json/decode.h"

struct proto_object {
    const json_t *value;
    const char *place; /* its JSON Pointer */
    struct proto_problem *problem;
};

/* The contract's rule for a member. The limits apply to a number's value or to an array's
 * length. */
struct proto_rule {
    const char *name;
    bool is_required;
    bool is_above; /* a number must exceed `least` */
    double least, most;
    /* sentence for a value outside the limits, or for a value that is not an array */
    const char *refusal;
    const char *expected; /* sentence for a value that is not an array, if it differs; or NULL */
    /* sentence for a value above `most`, if the problem is too_large; or NULL */
    const char *too_large;
    const char *const *words; /* allowed words, NULL-terminated */
};

/* Bytes of the place of a value that a request keeps. A longer place is truncated. */
#define PROTO_KEPT_PLACE 64
void proto_place_keep(char out[PROTO_KEPT_PLACE], const char *place);

/* Lists of numbers in a request, owned. All zero is an empty list. */
struct proto_reals {
    double *items;
    uint32_t count;
};
struct proto_indices {
    uint32_t *items;
    uint32_t count;
};
void proto_reals_free(struct proto_reals *reals); /* leaves an empty list */
void proto_indices_free(struct proto_indices *indices);

/* Returns whether the object has the member. */
bool proto_object_has(const struct proto_object *object, const char *name);

/* Returns the member and its place; NULL if it is missing, with a problem if it is required. */
const json_t *proto_object_find(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE]);

/* Like proto_object_find, but the member must be an array, whose length is checked. Sets `*ok` to
 * false if there is a problem. */
const json_t *proto_object_list(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE], bool *ok);

/* Checks that exactly one of two members is present. Otherwise `refusal` is the problem's
 * sentence. */
bool proto_object_one_of(const struct proto_object *object, const char *a, const char *b,
                         const char *refusal);

/* Finds the form of an object. `forms` has the names of the forms (NULL-terminated). A form is
 * present if the object has the member of that name. Sets `*out` to the index of the first form
 * that is present. If `members` is not NULL, it lists the members of all forms, and only one form
 * may be present. `refusal` is the sentence of the problem if no form is present, or a second
 * one. */
bool proto_object_form(const struct proto_object *object, const char *const *members,
                       const char *const *forms, const char *refusal, unsigned *out);

bool proto_take_number(const struct proto_object *object, const struct proto_rule *rule,
                       double *out);
bool proto_take_index(const struct proto_object *object, const struct proto_rule *rule,
                      uint32_t *out);
bool proto_take_flag(const struct proto_object *object, const struct proto_rule *rule, bool *out);

/* Reads one of the rule's words as its index. */
bool proto_take_word(const struct proto_object *object, const struct proto_rule *rule,
                     unsigned *out);

/* Reads an array of exactly `count` numbers or indices; the rule's limits apply to each index. */
bool proto_take_numbers(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, double *out);
bool proto_take_indices(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, uint32_t *out);

/* Read an array of any numbers or indices; the rule's limits apply to its length. */
bool proto_take_reals(const struct proto_object *object, const struct proto_rule *rule,
                      struct proto_reals *out);
bool proto_take_index_list(const struct proto_object *object, const struct proto_rule *rule,
                           struct proto_indices *out);

/* Checks that the value is within the rule's limits. If not, returns false with the problem at
 * `place`. */
bool proto_rule_check(const struct proto_rule *rule, double value, const char *place,
                      struct proto_problem *problem);
