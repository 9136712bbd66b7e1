#include "proto/values/limit_place.h"

#include <stdlib.h>

#include "proto/json/writer.h"
#include "proto/values/point.h"

void proto_limit_places_free(struct proto_limit_places *places)
{
    free(places->items);
    *places = (struct proto_limit_places){0};
}

bool proto_limit_place_locate(const struct gd_subdivision *surface,
                              const struct proto_limit_place *place, const char *pointer,
                              struct gd_limit_point *out, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    struct gd_limit_point point = {
        .face = place->face, .corner = place->corner, .u = place->uv[0], .v = place->uv[1]};
    enum gd_status status = gd_limit_place_check(surface, &point, &detail);
    *out = point;
    if (!status) return true;
    proto_problem_from_status(problem, status == GD_INVALID_ARGUMENT ? GD_NOT_ON_SURFACE : status,
                              &detail);
    proto_problem_at(problem, pointer);
    return proto_problem_descend(problem, status == GD_INVALID_ARGUMENT ? "uv" : "face");
}

bool proto_limit_places_locate(const struct gd_subdivision *surface,
                               const struct proto_limit_place_list *list,
                               struct proto_limit_places *out, struct proto_problem *problem)
{
    struct proto_limit_places places = {.items = malloc(list->count * sizeof *places.items)};
    if (!places.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (; places.count < list->count; places.count++) {
        char pointer[PROTO_PLACE];
        proto_place_of_element(pointer, "/points", places.count);
        if (proto_limit_place_locate(surface, &list->items[places.count], pointer,
                                     &places.items[places.count], problem))
            continue;
        proto_limit_places_free(&places);
        return false;
    }
    *out = places;
    return true;
}

/* --- in answers ------------------------------------------------------------------------------- */

void proto_limit_place_encode(struct proto_writer *writer, const struct gd_limit_point *place,
                              struct gd_vec3 xyz)
{
    proto_write_object_begin(writer);
    proto_member_uint(writer, "face", place->face);
    if (place->corner) proto_member_uint(writer, "corner", place->corner);
    proto_member_numbers(writer, "uv", (double[]){place->u, place->v}, 2);
    proto_member_xyz(writer, "xyz", xyz);
    proto_write_object_end(writer);
}
