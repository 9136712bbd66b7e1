#include "proto/queries/made_mesh.h"

#include "proto/json/writer.h"
#include "proto/queries/limit_paths.h"

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
        proto_member_array(writer, "places");
        for (uint32_t i = 0; i < places->count; i++) {
            const struct gd_limit_point *place = &places->items[i];
            proto_write_numbers(writer, (double[]){place->face, place->corner, place->u, place->v},
                                4);
        }
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

/* --- the request ------------------------------------------------------------------------------ */

static bool check_resolution(const uint32_t steps[2], uint32_t max_faces,
                             struct proto_problem *problem)
{
    uint32_t most = max_faces < GD_TESSELLATION_FACES_MAX ? max_faces : GD_TESSELLATION_FACES_MAX;
    if (2.0 * steps[0] * steps[1] <= most) return true;
    return proto_problem_exceed(problem, "/resolution", most,
                                "%u x %u cells are %.0f triangles, and at most %u can be made",
                                steps[0], steps[1], 2.0 * steps[0] * steps[1], most);
}

bool proto_tessellation_decode(const json_t *document, uint32_t max_faces,
                               struct proto_tessellation *out, struct proto_problem *problem)
{
    struct proto_tessellate_request request;
    if (!proto_tessellate_request_decode(document, &request, problem)) return false;
    if (request.has_resolution && !check_resolution(request.resolution, max_faces, problem))
        return false;
    *out = (struct proto_tessellation){
        request.mesh,
        {.deviation = request.tolerance,
         /* with a tolerance: the least number of faces, so that only the tolerance counts */
         .faces = request.has_tolerance,
         .steps = {request.resolution[0], request.resolution[1]}}};
    return true;
}

/* --- the vertices ----------------------------------------------------------------------------- */

static void encode_periods(struct proto_writer *writer, const double period[2])
{
    proto_member_array(writer, "periods");
    for (int k = 0; k < 2; k++) {
        if (period[k] > 0)
            proto_write_number(writer, period[k]);
        else
            proto_write_null(writer);
    }
    proto_write_array_end(writer);
}

void proto_vertex_parameters_encode(struct proto_writer *writer,
                                    const struct proto_vertex_parameters *parameters,
                                    uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_VERTEX_PARAMETERS_FIELD_NURBS)
        proto_made_of_encode(writer, "nurbs", parameters->surface, parameters->etag);
    if (fields & PROTO_VERTEX_PARAMETERS_FIELD_PERIODS) encode_periods(writer, parameters->period);
    if (fields & PROTO_VERTEX_PARAMETERS_FIELD_UV) {
        proto_member_array(writer, "uv");
        for (uint32_t i = 0; i < parameters->count; i++)
            proto_write_numbers(writer, parameters->uv[i], 2);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
