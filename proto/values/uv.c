#include "proto/values/uv.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/json/decode.h"

void proto_uvs_free(struct proto_uvs *uvs)
{
    free(uvs->items);
    *uvs = (struct proto_uvs){0};
}

bool proto_uv_decode(const json_t *object, const char *place, const char *member, double out[2],
                     struct proto_problem *problem)
{
    return proto_decode_numbers(object, place, member, 2, out, problem);
}

/* The member, an array of 1 to `most` elements; else NULL. */
static const json_t *find_list(const json_t *object, const char *place, const char *member,
                               uint32_t most, struct proto_problem *problem)
{
    const json_t *list = proto_decode_member(object, place, member, problem);
    size_t size = json_array_size(list); /* 0 when it is no array */
    if (!list || (size > 0 && size <= most)) return list;
    if (size == 0) {
        proto_problem_refuse(problem, place, "expected an array of at least one element");
    } else {
        proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                          "at most %u elements are taken here; send fewer", most);
        proto_problem_at(problem, place);
        proto_problem_limit(problem, most);
    }
    proto_problem_descend(problem, member);
    return NULL;
}

static bool refuse_element(const char *place, const char *member, size_t index,
                           const char *expected, struct proto_problem *problem)
{
    char list[PROTO_PLACE], element[PROTO_PLACE];
    proto_place_of_member(list, place, member);
    proto_place_of_element(element, list, index);
    return proto_problem_refuse(problem, element, "expected %s", expected);
}

static bool is_pair(const json_t *value)
{
    return json_array_size(value) == 2 && json_is_number(json_array_get(value, 0)) &&
           json_is_number(json_array_get(value, 1));
}

bool proto_uvs_decode(const json_t *object, const char *place, const char *member, uint32_t most,
                      struct proto_uvs *out, struct proto_problem *problem)
{
    const json_t *list = find_list(object, place, member, most, problem);
    if (!list) return false;
    struct proto_uvs uvs = {.count = (uint32_t)json_array_size(list)};
    uvs.items = malloc(uvs.count * sizeof *uvs.items);
    if (!uvs.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < uvs.count; i++) {
        const json_t *pair = json_array_get(list, i);
        if (!is_pair(pair)) {
            proto_uvs_free(&uvs);
            return refuse_element(place, member, i, "an array of 2 numbers", problem);
        }
        for (int k = 0; k < 2; k++)
            uvs.items[i][k] = json_number_value(json_array_get(pair, (size_t)k));
    }
    *out = uvs;
    return true;
}

bool proto_numbers_decode(const json_t *object, const char *place, const char *member,
                          uint32_t most, double **out, uint32_t *count,
                          struct proto_problem *problem)
{
    const json_t *list = find_list(object, place, member, most, problem);
    if (!list) return false;
    uint32_t size = (uint32_t)json_array_size(list);
    double *numbers = malloc(size * sizeof *numbers);
    if (!numbers) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    if (!proto_decode_numbers(object, place, member, size, numbers, problem)) {
        free(numbers);
        return false;
    }
    *out = numbers;
    *count = size;
    return true;
}

bool proto_uv_check(const struct gd_parametric *surface, const double uv[2], const char *place,
                    struct proto_problem *problem)
{
    if (gd_parametric_contains(surface, uv[0], uv[1])) return true;
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    proto_problem_set(
        problem, PROTO_PROBLEM_POINT_NOT_ON_SURFACE,
        "(%.17g, %.17g) lies outside the surface's domain, [%.17g, %.17g]%s x [%.17g, %.17g]%s",
        uv[0], uv[1], u->low, u->high, u->closed ? " (periodic)" : "", v->low, v->high,
        v->closed ? " (periodic)" : "");
    return proto_problem_at(problem, place);
}
