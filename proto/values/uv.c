#include "proto/values/uv.h"

#include <stdlib.h>

void proto_uvs_free(struct proto_uvs *uvs)
{
    free(uvs->items);
    *uvs = (struct proto_uvs){0};
}

bool proto_take_uvs(const struct proto_object *object, const struct proto_rule *rule,
                    struct proto_uvs *out)
{
    bool ok;
    char place[PROTO_PLACE], element[PROTO_PLACE];
    const json_t *list = proto_object_list(object, rule, place, &ok);
    if (!list) return ok;
    struct proto_uvs uvs = {.count = (uint32_t)json_array_size(list)};
    uvs.items = malloc((uvs.count + (size_t)1) * sizeof *uvs.items);
    if (!uvs.items) return proto_problem_from_status(object->problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < uvs.count; i++) {
        if (proto_read_numbers(json_array_get(list, i), 2, uvs.items[i])) continue;
        proto_uvs_free(&uvs);
        proto_place_of_element(element, place, i);
        return proto_problem_refuse(object->problem, element, "expected an array of 2 numbers");
    }
    *out = uvs;
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
    bool is_trimmed_off = (u->closed || (uv[0] >= u->low && uv[0] <= u->high)) &&
                          (v->closed || (uv[1] >= v->low && uv[1] <= v->high));
    if (is_trimmed_off) {
        proto_problem_set(problem, PROTO_PROBLEM_POINT_NOT_ON_SURFACE,
                          "(%.17g, %.17g) is cut away by the trimming loops; choose a point inside "
                          "the outer loop and outside the holes, or ask nearest for one",
                          uv[0], uv[1]);
        return proto_problem_at(problem, place);
    }
    proto_problem_set(
        problem, PROTO_PROBLEM_POINT_NOT_ON_SURFACE,
        "(%.17g, %.17g) lies outside the surface's domain, [%.17g, %.17g]%s x [%.17g, %.17g]%s",
        uv[0], uv[1], u->low, u->high, u->closed ? " (periodic)" : "", v->low, v->high,
        v->closed ? " (periodic)" : "");
    return proto_problem_at(problem, place);
}
