#include "proto/json/object.h"

#include <string.h>

bool proto_object_has(const struct proto_object *object, const char *name)
{
    return json_object_get(object->value, name) != NULL;
}

const json_t *proto_object_find(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE])
{
    proto_place_of_member(place, object->place, rule->name);
    return rule->is_required
               ? proto_decode_member(object->value, object->place, rule->name, object->problem)
               : json_object_get(object->value, rule->name);
}

bool proto_object_one_of(const struct proto_object *object, const char *a, const char *b,
                         const char *refusal)
{
    return proto_object_has(object, a) != proto_object_has(object, b) ||
           proto_problem_refuse(object->problem, object->place, "%s", refusal);
}

/* --- limits ----------------------------------------------------------------------------------- */

bool proto_rule_check(const struct proto_rule *rule, double value, const char *place,
                      struct proto_problem *problem)
{
    bool is_enough = rule->is_above ? value > rule->least : value >= rule->least;
    if (is_enough && value <= rule->most) return true;
    if (!is_enough || !rule->too_large)
        return proto_problem_refuse(problem, place, "%s", rule->refusal);
    return proto_problem_exceed(problem, place, (uint64_t)rule->most, "%s", rule->too_large);
}

const json_t *proto_object_list(const struct proto_object *object, const struct proto_rule *rule,
                                char place[PROTO_PLACE], bool *ok)
{
    const json_t *list = proto_object_find(object, rule, place);
    *ok = list || !rule->is_required;
    if (!list) return NULL;
    *ok = json_is_array(list)
              ? proto_rule_check(rule, (double)json_array_size(list), place, object->problem)
              : proto_problem_refuse(object->problem, place, "%s",
                                     rule->expected ? rule->expected : rule->refusal);
    return *ok ? list : NULL;
}

/* --- members ---------------------------------------------------------------------------------- */

static bool is_absent(const struct proto_object *object, const struct proto_rule *rule)
{
    return !rule->is_required && !proto_object_has(object, rule->name);
}

static bool check_value(const struct proto_object *object, const struct proto_rule *rule,
                        double value)
{
    char place[PROTO_PLACE];
    proto_place_of_member(place, object->place, rule->name);
    return proto_rule_check(rule, value, place, object->problem);
}

bool proto_take_number(const struct proto_object *object, const struct proto_rule *rule,
                       double *out)
{
    return is_absent(object, rule) ||
           (proto_decode_number(object->value, object->place, rule->name, out, object->problem) &&
            check_value(object, rule, *out));
}

bool proto_take_index(const struct proto_object *object, const struct proto_rule *rule,
                      uint32_t *out)
{
    return is_absent(object, rule) ||
           (proto_decode_index(object->value, object->place, rule->name, out, object->problem) &&
            check_value(object, rule, *out));
}

bool proto_take_flag(const struct proto_object *object, const struct proto_rule *rule, bool *out)
{
    return is_absent(object, rule) ||
           proto_decode_flag(object->value, object->place, rule->name, out, object->problem);
}

bool proto_take_word(const struct proto_object *object, const struct proto_rule *rule,
                     unsigned *out)
{
    char place[PROTO_PLACE];
    const json_t *value = proto_object_find(object, rule, place);
    if (!value) return !rule->is_required;
    for (unsigned i = 0; json_is_string(value) && rule->words[i]; i++) {
        *out = i;
        if (strcmp(json_string_value(value), rule->words[i]) == 0) return true;
    }
    return proto_problem_refuse(object->problem, place, "%s", rule->refusal);
}

bool proto_take_numbers(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, double *out)
{
    return is_absent(object, rule) || proto_decode_numbers(object->value, object->place, rule->name,
                                                           count, out, object->problem);
}

bool proto_take_indices(const struct proto_object *object, const struct proto_rule *rule,
                        size_t count, uint32_t *out)
{
    if (is_absent(object, rule)) return true;
    bool ok =
        proto_decode_indices(object->value, object->place, rule->name, count, out, object->problem);
    for (size_t i = 0; i < count && ok; i++) ok = check_value(object, rule, out[i]);
    return ok;
}
