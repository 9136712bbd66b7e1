/* Object: an object of a request while it is decoded, and the rules of its members, which are
 * generated from the contract (generated/requests.c).
 *
 * Each function that takes a member returns true, or false with a problem at the member. Where a
 * member that is not required is missing, `*out` keeps its value. */
#ifndef PROTO_OBJECT_H
#define PROTO_OBJECT_H

#include "proto/json/decode.h"

struct proto_object {
    const json_t *value;
    const char *place; /* its JSON Pointer */
    struct proto_problem *problem;
};

/* What the contract says of a member. Limits are of a number's value or of an array's length. */
struct proto_rule {
    const char *name;
    bool is_required;
    bool is_above; /* a number is more than `least` */
    double least, most;
    const char *refusal;      /* a value outside the limits, or what is no array */
    const char *expected;     /* the latter, if it is another sentence; or NULL */
    const char *too_large;    /* a value above `most` is too_large, not invalid_request; or NULL */
    const char *const *words; /* of a word, NULL-terminated */
};

/* True if the object has the member. */
bool proto_object_has(const struct proto_object *object, const char *name);

/* The member, and its place; NULL: there is none, which is a problem if it is required. */
const json_t *proto_object_find(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE]);

/* The same for an array, whose length is within the limits; `*ok`: there is no problem. */
const json_t *proto_object_list(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE], bool *ok);

/* Exactly one of two members is there; else the sentence is the problem. */
bool proto_object_one_of(const struct proto_object *object, const char *a, const char *b,
                         const char *refusal);

bool proto_take_number(const struct proto_object *object, const struct proto_rule *rule,
                       double *out);
bool proto_take_index(const struct proto_object *object, const struct proto_rule *rule,
                      uint32_t *out);
bool proto_take_flag(const struct proto_object *object, const struct proto_rule *rule, bool *out);

/* One of the rule's words: its number. */
bool proto_take_word(const struct proto_object *object, const struct proto_rule *rule,
                     unsigned *out);

/* An array of exactly `count` numbers or indices; the limits are of each index. */
bool proto_take_numbers(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, double *out);
bool proto_take_indices(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, uint32_t *out);

/* A value outside the rule's limits: the problem at the place. True if it is within them. */
bool proto_rule_check(const struct proto_rule *rule, double value, const char *place,
                      struct proto_problem *problem);

#endif
