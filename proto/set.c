#include "proto/set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/decode.h"

static bool refuse_memory(struct proto_problem *problem)
{
    return proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "there is no memory for a set of so many members; try again later");
}

/* --- members ---------------------------------------------------------------------------------------------------- */

static bool decode_offset(const json_t *value, const char *place, double *out, struct proto_problem *problem)
{
    double offset = 0;
    if (json_object_get(value, "offset") && !proto_decode_number(value, place, "offset", &offset, problem))
        return false;
    if (!(offset >= 0 && offset <= PROTO_SET_OFFSET)) {
        proto_problem_refuse(problem, place, "an offset is added to distances: from 0 to %g", PROTO_SET_OFFSET);
        return proto_problem_descend(problem, "offset");
    }
    *out = offset + 0.0; /* no -0: it would be another set */
    return true;
}

static bool decode_label(const json_t *value, const char *place, const char **out, struct proto_problem *problem)
{
    const json_t *label = json_object_get(value, "label");
    if (label && (!json_is_string(label) || json_string_length(label) > PROTO_SET_LABEL)) {
        proto_problem_refuse(problem, place, "a label is a string of at most %d bytes", PROTO_SET_LABEL);
        return proto_problem_descend(problem, "label");
    }
    *out = json_string_value(label);
    return true;
}

/* What is a member's own aside, a member is a point. */
static bool decode_point(const json_t *value, const char *place, struct proto_point *out, struct proto_problem *problem)
{
    if (!json_object_get(value, "offset") && !json_object_get(value, "label"))
        return proto_point_decode(value, place, out, problem);
    json_t *point = json_copy((json_t *)value);
    if (!point) return refuse_memory(problem);
    json_object_del(point, "offset");
    json_object_del(point, "label");
    bool ok = proto_point_decode(point, place, out, problem);
    json_decref(point);
    return ok;
}

static bool decode_member(const json_t *value, const char *place, struct proto_member *out,
                          struct proto_problem *problem)
{
    return decode_point(value, place, &out->point, problem) && decode_offset(value, place, &out->offset, problem) &&
           decode_label(value, place, &out->label, problem);
}

/* --- the set ---------------------------------------------------------------------------------------------------- */

static bool refuse_curves(const json_t *value, const char *pointer, struct proto_problem *problem)
{
    static const char *const kinds[] = {"curves", "boundaries"};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (!json_object_get(value, kinds[i])) continue;
        proto_problem_refuse(problem, pointer, "sets of %s are not taken by this version; name points", kinds[i]);
        return proto_problem_descend(problem, kinds[i]);
    }
    return true;
}

/* The array of members, or NULL. */
static const json_t *find_members(const json_t *value, const char *pointer, struct proto_problem *problem)
{
    static const char *const members[] = {"points", "curves", "boundaries", NULL};
    if (!proto_decode_object(value, pointer, members, problem) || !refuse_curves(value, pointer, problem)) return NULL;
    const json_t *points = proto_decode_member(value, pointer, "points", problem);
    if (!points) return NULL;
    size_t count = json_array_size(points); /* 0 when it is no array */
    if (count > 0 && count <= PROTO_SET_MEMBERS) return points;
    if (count == 0) {
        proto_problem_refuse(problem, pointer, "expected an array of points, one at least");
    } else {
        proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE, "a set may have %d members at most", PROTO_SET_MEMBERS);
        proto_problem_at(problem, pointer);
        proto_problem_limit(problem, PROTO_SET_MEMBERS);
    }
    proto_problem_descend(problem, "points");
    return NULL;
}

bool proto_set_decode(const json_t *value, const char *pointer, struct proto_set *out, struct proto_problem *problem)
{
    const json_t *points = find_members(value, pointer, problem);
    if (!points) return false;
    struct proto_set set = {.count = (uint32_t)json_array_size(points)};
    set.members = malloc(set.count * sizeof *set.members);
    if (!set.members) return refuse_memory(problem);
    for (uint32_t i = 0; i < set.count; i++) {
        char place[PROTO_POINT_PLACE];
        snprintf(place, sizeof place, "%s/points/%u", pointer, i);
        if (decode_member(json_array_get(points, i), place, &set.members[i], problem)) continue;
        proto_set_free(&set);
        return false;
    }
    *out = set;
    return true;
}

void proto_set_free(struct proto_set *set)
{
    free(set->members);
    *set = (struct proto_set){0};
}

/* --- onto the mesh ---------------------------------------------------------------------------------------------- */

static size_t label_size(const struct proto_set *set)
{
    size_t size = 0;
    for (uint32_t i = 0; i < set->count; i++)
        if (set->members[i].label) size += strlen(set->members[i].label) + 1;
    return size;
}

static bool locate_seeds(const struct gd_mesh *mesh, const struct proto_set *set, struct gd_seed *seeds,
                         struct proto_problem *problem)
{
    double snap_distance;
    for (uint32_t i = 0; i < set->count; i++) {
        if (!proto_point_locate(mesh, &set->members[i].point, &seeds[i].point, &snap_distance, problem)) return false;
        seeds[i].offset = set->members[i].offset;
    }
    return true;
}

static void copy_labels(const struct proto_set *set, uint32_t *offsets, char *labels)
{
    size_t used = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        const char *label = set->members[i].label;
        offsets[i] = label ? (uint32_t)used : UINT32_MAX;
        if (label) used = (size_t)(stpcpy(labels + used, label) + 1 - labels);
    }
}

struct proto_located_set *proto_set_locate(const struct gd_mesh *mesh, const struct proto_set *set,
                                           struct proto_problem *problem)
{
    size_t text = label_size(set);
    size_t bytes = sizeof(struct proto_located_set) + set->count * (sizeof(struct gd_seed) + sizeof(uint32_t)) + text;
    struct proto_located_set *located = malloc(bytes);
    if (!located) {
        refuse_memory(problem);
        return NULL;
    }
    struct gd_seed *seeds = (struct gd_seed *)(located + 1);
    uint32_t *offsets = (uint32_t *)(seeds + set->count);
    char *labels = (char *)(offsets + set->count);
    if (!locate_seeds(mesh, set, seeds, problem)) {
        free(located);
        return NULL;
    }
    copy_labels(set, offsets, labels);
    *located = (struct proto_located_set){set->count, seeds, offsets, labels, text, bytes};
    return located;
}

const char *proto_located_set_label(const struct proto_located_set *set, uint32_t member)
{
    uint32_t at = set->label_offsets[member];
    return at == UINT32_MAX ? NULL : set->labels + at;
}
