#include "proto/json/object.h"

#include <stdlib.h>
#include <string.h>

void proto_place_keep(char out[PROTO_KEPT_PLACE], const char *place)
{
    size_t size = strnlen(place, PROTO_KEPT_PLACE - 1);
    memcpy(out, place, size);
    out[size] = '\0';
}

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

bool proto_object_form(const struct proto_object *object, const char *const *members,
                       const char *const *forms, const char *refusal, unsigned *out)
{
    unsigned count = 0;
    if (members && !proto_decode_object(object->value, object->place, members, object->problem))
        return false;
    for (unsigned i = 0; forms[i] && (members || !count); i++) {
        if (!proto_object_has(object, forms[i])) continue;
        *out = i;
        count++;
    }
    return count == 1 || proto_problem_refuse(object->problem, object->place, "%s", refusal);
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
    if (is_absent(object, rule)) return true;
    /* first the limits: their sentence has the valid values */
    const json_t *value = json_object_get(object->value, rule->name);
    if (json_is_number(value) && rule->refusal &&
        !check_value(object, rule, json_number_value(value)))
        return false;
    return proto_decode_index(object->value, object->place, rule->name, out, object->problem) &&
           check_value(object, rule, *out);
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

/* --- lists of numbers ------------------------------------------------------------------------- */

void proto_reals_free(struct proto_reals *reals)
{
    free(reals->items);
    *reals = (struct proto_reals){0};
}

void proto_indices_free(struct proto_indices *indices)
{
    free(indices->items);
    *indices = (struct proto_indices){0};
}

/* Allocates room for the numbers of a list and one more, `size` bytes each. Returns NULL if the
 * list is missing. On failure, returns NULL with the problem and sets `*ok` to false. */
static void *make_room(const struct proto_object *object, const struct proto_rule *rule,
                       size_t size, uint32_t *count, bool *ok)
{
    char place[PROTO_PLACE];
    const json_t *list = proto_object_list(object, rule, place, ok);
    if (!list) return NULL;
    *count = (uint32_t)json_array_size(list);
    void *items = malloc((*count + (size_t)1) * size);
    if (!items) *ok = proto_problem_from_status(object->problem, GD_NO_MEMORY, NULL);
    return items;
}

bool proto_take_reals(const struct proto_object *object, const struct proto_rule *rule,
                      struct proto_reals *out)
{
    bool ok;
    out->items = make_room(object, rule, sizeof *out->items, &out->count, &ok);
    return out->items ? proto_decode_numbers(object->value, object->place, rule->name, out->count,
                                             out->items, object->problem)
                      : ok;
}

bool proto_take_index_list(const struct proto_object *object, const struct proto_rule *rule,
                           struct proto_indices *out)
{
    bool ok;
    out->items = make_room(object, rule, sizeof *out->items, &out->count, &ok);
    return out->items ? proto_decode_indices(object->value, object->place, rule->name, out->count,
                                             out->items, object->problem)
                      : ok;
}
