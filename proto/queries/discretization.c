#include "proto/queries/discretization.h"

#include "proto/json/decode.h"
#include "proto/queries/limit_trace.h"
#include "proto/values/made_mesh.h"

const char *const proto_vertex_places_fields[] = {"subdivision", "places", NULL};

bool proto_discretization_decode(const json_t *document, const struct gd_subdivision *surface,
                                 uint32_t max_faces, struct proto_discretization *out,
                                 struct proto_problem *problem)
{
    static const char *const members[] = {"mesh", "level", "tolerance", NULL};
    struct proto_discretization wanted = {.options = {.max_faces = max_faces}};
    if (!proto_decode_object(document, "", members, problem)) return false;
    bool has_level = json_object_get(document, "level") != NULL;
    if (has_level == (json_object_get(document, "tolerance") != NULL))
        return proto_problem_refuse(
            problem, "",
            "say either level, how often edges are halved, or tolerance, how near the mesh is");
    if (!proto_made_mesh_decode(document, wanted.mesh, problem)) return false;
    if (has_level ? !proto_limit_level_decode(document, surface, &wanted.options.level, problem)
                  : !proto_made_tolerance_decode(document, &wanted.options.tolerance, problem))
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
