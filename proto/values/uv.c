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

/* Returns the member if it is an array of 1 to `most` elements; else NULL. */
static const json_t *find_list(const json_t *object, const char *place, const char *member,
                               uint32_t most, struct proto_problem *problem)
{
    const json_t *list = proto_decode_member(object, place, member, problem);
    size_t size = json_array_size(list); /* 0 if it is not an array */
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

bool proto_uvs_decode(const json_t *object, const char *place, const char *member, uint32_t most,
                      struct proto_uvs *out, struct proto_problem *problem)
{
    const json_t *list = find_list(object, place, member, most, problem);
    if (!list) return false;
    struct proto_uvs uvs = {.count = (uint32_t)json_array_size(list)};
    uvs.items = malloc(uvs.count * sizeof *uvs.items);
    if (!uvs.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < uvs.count; i++) {
        char list_place[PROTO_PLACE], element[PROTO_PLACE];
        if (proto_read_numbers(json_array_get(list, i), 2, uvs.items[i])) continue;
        proto_uvs_free(&uvs);
        proto_place_of_member(list_place, place, member);
        proto_place_of_element(element, list_place, i);
        return proto_problem_refuse(problem, element, "expected an array of 2 numbers");
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

bool proto_knots_check(uint32_t points, uint32_t degree, uint32_t knots, const char *place,
                       struct proto_problem *problem)
{
    uint64_t needed = (uint64_t)points + degree + 1;
    return knots == needed ||
           proto_problem_refuse_member(problem, place, "knots",
                                       "%u control points of degree %u need %llu knots, not %u",
                                       points, degree, (unsigned long long)needed, knots);
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
