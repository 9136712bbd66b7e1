#include "proto/values/limit_place.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"
#include "proto/values/point.h"

void proto_limit_places_free(struct proto_limit_places *places)
{
    free(places->items);
    *places = (struct proto_limit_places){0};
}

/* --- from the request ------------------------------------------------------------------------- */

static bool check(const struct gd_subdivision *surface, struct gd_limit_point *place,
                  const char *pointer, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    enum gd_status status = gd_limit_place_check(surface, place, &detail);
    if (!status) return true;
    proto_problem_from_status(problem, status == GD_INVALID_ARGUMENT ? GD_NOT_ON_SURFACE : status,
                              &detail);
    proto_problem_at(problem, pointer);
    return proto_problem_descend(problem, status == GD_INVALID_ARGUMENT ? "uv" : "face");
}

static bool decode(const json_t *value, const char *pointer, const struct gd_subdivision *surface,
                   struct gd_limit_point *out, struct proto_problem *problem)
{
    static const char *const members[] = {"face", "uv", "corner", NULL};
    struct gd_limit_point place = {0};
    double uv[2];
    if (!proto_decode_object(value, pointer, members, problem) ||
        !proto_decode_index(value, pointer, "face", &place.face, problem) ||
        !proto_decode_numbers(value, pointer, "uv", 2, uv, problem))
        return false;
    if (json_object_get(value, "corner") &&
        !proto_decode_index(value, pointer, "corner", &place.corner, problem))
        return false;
    place.u = uv[0];
    place.v = uv[1];
    if (!check(surface, &place, pointer, problem)) return false;
    *out = place;
    return true;
}

bool proto_limit_place_decode(const json_t *document, const char *member,
                              const struct gd_subdivision *surface, struct gd_limit_point *out,
                              struct proto_problem *problem)
{
    char pointer[PROTO_POINT_PLACE];
    const json_t *value = proto_decode_member(document, "", member, problem);
    snprintf(pointer, sizeof pointer, "/%s", member);
    return value && decode(value, pointer, surface, out, problem);
}

static const json_t *find_points(const json_t *document, struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", "points", problem);
    if (!value) return NULL;
    size_t count = json_array_size(value); /* 0 when it is no array */
    if (count > 0 && count <= PROTO_LIMIT_PLACES) return value;
    if (count == 0) {
        proto_problem_refuse(problem, "/points", "expected an array of at least one place");
        return NULL;
    }
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "at most %d places are taken here; send fewer", PROTO_LIMIT_PLACES);
    proto_problem_at(problem, "/points");
    proto_problem_limit(problem, PROTO_LIMIT_PLACES);
    return NULL;
}

bool proto_limit_places_decode(const json_t *document, const struct gd_subdivision *surface,
                               struct proto_limit_places *out, struct proto_problem *problem)
{
    const json_t *value = find_points(document, problem);
    if (!value) return false;
    struct proto_limit_places places = {.count = (uint32_t)json_array_size(value)};
    places.items = malloc(places.count * sizeof *places.items);
    if (!places.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < places.count; i++) {
        char pointer[PROTO_POINT_PLACE];
        snprintf(pointer, sizeof pointer, "/points/%u", i);
        if (decode(json_array_get(value, i), pointer, surface, &places.items[i], problem)) continue;
        proto_limit_places_free(&places);
        return false;
    }
    *out = places;
    return true;
}

/* --- in answers ------------------------------------------------------------------------------- */

void proto_limit_place_write(struct proto_writer *writer, const struct gd_limit_point *place)
{
    proto_member_uint(writer, "face", place->face);
    if (place->corner) proto_member_uint(writer, "corner", place->corner);
    proto_write_key(writer, "uv");
    proto_write_numbers(writer, (double[]){place->u, place->v}, 2);
}

void proto_limit_place_encode(struct proto_writer *writer, const struct gd_limit_point *place,
                              struct gd_vec3 xyz)
{
    proto_write_object_begin(writer);
    proto_limit_place_write(writer, place);
    proto_member_xyz(writer, "xyz", xyz);
    proto_write_object_end(writer);
}
