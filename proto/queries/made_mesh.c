#include "proto/queries/made_mesh.h"

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
         /* if a tolerance is given, the least number of faces, so that only the tolerance counts */
         .faces = request.has_tolerance,
         .steps = {request.resolution[0], request.resolution[1]},
         .max_faces = max_faces}};
    return true;
}
