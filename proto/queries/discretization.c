#include "proto/queries/discretization.h"

#include "proto/queries/limit_trace.h"
#include "proto/values/mesh.h"

bool proto_discretization_decode(const json_t *document, const struct gd_subdivision *surface,
                                 uint32_t max_faces, struct proto_discretization *out,
                                 struct proto_problem *problem)
{
    struct proto_discretize_request request;
    if (!proto_discretize_request_decode(document, &request, problem)) return false;
    struct proto_discretization wanted = {request.mesh,
                                          {.max_faces = max_faces, .tolerance = request.tolerance}};
    if (!request.has_tolerance &&
        !proto_limit_level_decode(document, surface, &wanted.options.level, problem))
        return false;
    *out = wanted;
    return true;
}

void proto_vertex_places_encode(struct proto_writer *writer,
                                const struct proto_vertex_places *places, uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_VERTEX_PLACES_FIELD_SUBDIVISION)
        proto_made_of_encode(writer, "subdivision", places->surface, places->etag);
    if (fields & PROTO_VERTEX_PLACES_FIELD_PLACES) {
        proto_write_key(writer, "places");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < places->count; i++) {
            const struct gd_limit_point *place = &places->items[i];
            proto_write_numbers(writer, (double[]){place->face, place->corner, place->u, place->v},
                                4);
        }
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
