#include "proto/values/set.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/requests.h"

static bool refuse_memory(struct proto_problem *problem)
{
    return proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "there is no memory for a set of so many members; try again later");
}

/* --- members ---------------------------------------------------------------------------------- */

static bool decode_offset(const json_t *value, const char *place, double *out,
                          struct proto_problem *problem)
{
    double offset = 0;
    if (json_object_get(value, "offset") &&
        !proto_decode_number(value, place, "offset", &offset, problem))
        return false;
    if (!(offset >= 0 && offset <= PROTO_SET_OFFSET))
        return proto_problem_refuse_member(problem, place, "offset",
                                           "an offset is added to distances: from 0 to %g",
                                           PROTO_SET_OFFSET);
    *out = offset + 0.0; /* never -0, because that would make another set */
    return true;
}

static bool decode_label(const json_t *value, const char *place, const char **out,
                         struct proto_problem *problem)
{
    const json_t *label = json_object_get(value, "label");
    if (label && (!json_is_string(label) || json_string_length(label) > PROTO_SET_LABEL))
        return proto_problem_refuse_member(
            problem, place, "label", "a label is a string of at most %d bytes", PROTO_SET_LABEL);
    *out = json_string_value(label);
    return true;
}

/* Returns a member without its offset and label, as a new reference; NULL if out of memory. */
static json_t *without_naming(const json_t *value)
{
    if (!json_object_get(value, "offset") && !json_object_get(value, "label"))
        return json_incref((json_t *)value);
    json_t *bare = json_copy((json_t *)value);
    if (!bare) return NULL;
    /* json_copy omits members for which memory runs out */
    if (json_object_size(bare) != json_object_size(value)) {
        json_decref(bare);
        return NULL;
    }
    json_object_del(bare, "offset");
    json_object_del(bare, "label");
    return bare;
}

/* The kinds of members. A request has an array for each kind; each item of the array becomes a
 * member of the set. */
struct kind {
    const char *name;
    uint32_t most;
    bool (*decode)(const json_t *value, const char *place, struct proto_set *set,
                   struct proto_problem *problem);
};

static bool decode_point(const json_t *value, const char *place, struct proto_set *set,
                         struct proto_problem *problem)
{
    return proto_point_decode(value, place, &set->points[set->point_count], problem) &&
           ++set->point_count;
}

static bool decode_curve(const json_t *value, const char *place, struct proto_set *set,
                         struct proto_problem *problem)
{
    return proto_curve_decode(value, place, &set->curves[set->curve_count], problem) &&
           ++set->curve_count;
}

/* Decodes an index, or an object that contains it. */
static bool decode_boundary(const json_t *value, const char *place, struct proto_set *set,
                            struct proto_problem *problem)
{
    if (!json_is_number(value)) return decode_curve(value, place, set, problem);
    json_t *curve = json_pack("{s:O}", "boundary", value);
    if (!curve) return refuse_memory(problem);
    bool ok = decode_curve(curve, place, set, problem);
    json_decref(curve);
    return ok;
}

static const struct kind kinds[] = {{"points", PROTO_SET_MEMBERS, decode_point},
                                    {"curves", PROTO_SET_CURVES, decode_curve},
                                    {"boundaries", PROTO_SET_CURVES, decode_boundary}};
enum { POINTS, CURVES, BOUNDARIES, KINDS };

static bool decode_member(const struct kind *kind, const json_t *value, const char *place,
                          struct proto_set *set, struct proto_problem *problem)
{
    struct proto_naming *naming = &set->namings[set->point_count + set->curve_count];
    if (!decode_offset(value, place, &naming->offset, problem) ||
        !decode_label(value, place, &naming->label, problem))
        return false;
    json_t *bare = without_naming(value);
    if (!bare) return refuse_memory(problem);
    bool ok = kind->decode(bare, place, set, problem);
    json_decref(bare);
    return ok;
}

/* --- the set ---------------------------------------------------------------------------------- */

static bool refuse_number(const struct kind *kind, const char *pointer,
                          struct proto_problem *problem)
{
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE, "a set may have %u %s at most", kind->most,
                      kind->name);
    proto_problem_at(problem, pointer);
    proto_problem_limit(problem, kind->most);
    return proto_problem_descend(problem, kind->name);
}

static bool is_all(const json_t *value)
{
    return json_is_string(value) && strcmp(json_string_value(value), "all") == 0;
}

/* Finds the arrays and checks their sizes; missing arrays are NULL. */
static bool find_arrays(const json_t *value, const char *pointer, const json_t *arrays[KINDS],
                        struct proto_problem *problem)
{
    static const char *const members[] = {"points", "curves", "boundaries", NULL};
    size_t count = 0;
    if (!proto_decode_object(value, pointer, members, problem)) return false;
    for (int k = 0; k < KINDS; k++) {
        const json_t *array = json_object_get(value, kinds[k].name);
        bool all = k == BOUNDARIES && is_all(array);
        arrays[k] = all ? NULL : array;
        if (array && !all && !json_is_array(array))
            return proto_problem_refuse_member(problem, pointer, kinds[k].name,
                                               "expected an array of %s%s", kinds[k].name,
                                               k == BOUNDARIES ? ", or \"all\"" : "");
        if (json_array_size(arrays[k]) > kinds[k].most)
            return refuse_number(&kinds[k], pointer, problem);
        count += all ? 1 : json_array_size(arrays[k]);
    }
    return count ||
           proto_problem_refuse(
               problem, pointer,
               "name one member at least, among \"points\", \"curves\" and \"boundaries\"");
}

static bool make_room(struct proto_set *set, const json_t *const arrays[KINDS],
                      struct proto_problem *problem)
{
    size_t points = json_array_size(arrays[POINTS]),
           curves = json_array_size(arrays[CURVES]) + json_array_size(arrays[BOUNDARIES]);
    set->points = malloc((points + 1) * sizeof *set->points);
    set->curves = malloc((curves + 1) * sizeof *set->curves);
    set->namings = malloc((points + curves + 1) * sizeof *set->namings);
    return (set->points && set->curves && set->namings) || refuse_memory(problem);
}

/* Moves the set to the caller if it is complete, otherwise frees it. */
static bool hand_over(struct proto_set *set, bool ok, struct proto_set *out)
{
    if (ok)
        *out = *set;
    else
        proto_set_free(set);
    return ok;
}

static bool decode_kind(const struct kind *kind, const json_t *array, const char *pointer,
                        struct proto_set *set, struct proto_problem *problem)
{
    for (size_t i = 0; i < json_array_size(array); i++) {
        char place[PROTO_KEPT_PLACE];
        snprintf(place, sizeof place, "%s/%s/%zu", pointer, kind->name, i);
        if (!decode_member(kind, json_array_get(array, i), place, set, problem)) return false;
    }
    return true;
}

bool proto_set_decode(const json_t *value, const char *pointer, struct proto_set *out,
                      struct proto_problem *problem)
{
    const json_t *arrays[KINDS];
    if (!find_arrays(value, pointer, arrays, problem)) return false;
    struct proto_set set = {.all_boundaries = is_all(json_object_get(value, "boundaries")),
                            .document = json_incref((json_t *)value)};
    bool ok = make_room(&set, arrays, problem);
    for (int k = 0; k < KINDS && ok; k++)
        ok = decode_kind(&kinds[k], arrays[k], pointer, &set, problem);
    return hand_over(&set, ok, out);
}

bool proto_set_decode_curve(const json_t *object, const char *member, struct proto_set *out,
                            struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(object, "", member, problem), *arrays[KINDS] = {NULL};
    char place[PROTO_KEPT_PLACE];
    if (!value) return false;
    struct proto_set set = {.document = json_incref((json_t *)value)};
    snprintf(place, sizeof place, "/%s", member);
    bool ok = make_room(&set, arrays, problem);
    if (ok) {
        set.namings[0] = (struct proto_naming){0};
        ok = decode_curve(value, place, &set, problem);
    }
    return hand_over(&set, ok, out);
}

bool proto_set_of_point(const struct proto_point *point, struct proto_set *out,
                        struct proto_problem *problem)
{
    const json_t *arrays[KINDS] = {NULL};
    struct proto_set set = {0};
    bool ok = make_room(&set, arrays, problem);
    if (ok) {
        set.points[0] = *point;
        set.namings[0] = (struct proto_naming){0};
        set.point_count = 1;
    }
    return hand_over(&set, ok, out);
}

void proto_set_free(struct proto_set *set)
{
    for (uint32_t i = 0; i < set->curve_count; i++) proto_curve_free(&set->curves[i]);
    free(set->points);
    free(set->curves);
    free(set->namings);
    json_decref(set->document);
    *set = (struct proto_set){0};
}

bool proto_set_is_quick(const struct proto_set *set)
{
    return !set->curve_count && !set->all_boundaries;
}
