#include "proto/queries/tessellation.h"

#include "proto/json/decode.h"
#include "proto/values/made_mesh.h"

const char *const proto_vertex_parameters_fields[] = {"nurbs", "periods", "uv", NULL};

/* --- the request ------------------------------------------------------------------------------ */

static bool decode_resolution(const json_t *document, uint32_t max_faces,
                              struct gd_tessellation_options *out, struct proto_problem *problem)
{
    uint32_t most = max_faces < GD_TESSELLATION_FACES_MAX ? max_faces : GD_TESSELLATION_FACES_MAX;
    if (!proto_decode_indices(document, "", "resolution", 2, out->steps, problem)) return false;
    if (out->steps[0] < GD_TESSELLATION_STEPS_LEAST || out->steps[1] < GD_TESSELLATION_STEPS_LEAST)
        return proto_problem_refuse(problem, "/resolution",
                                    "each direction is cut into %d parts at least",
                                    GD_TESSELLATION_STEPS_LEAST);
    if (2.0 * out->steps[0] * out->steps[1] <= most) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "%u x %u cells are %.0f triangles, and at most %u can be made", out->steps[0],
                      out->steps[1], 2.0 * out->steps[0] * out->steps[1], most);
    proto_problem_at(problem, "/resolution");
    return proto_problem_limit(problem, most);
}

static bool decode_tolerance(const json_t *document, struct gd_tessellation_options *out,
                             struct proto_problem *problem)
{
    out->faces = 1; /* as few as the tolerance allows */
    return proto_made_tolerance_decode(document, &out->deviation, problem);
}

bool proto_tessellation_decode(const json_t *document, uint32_t max_faces,
                               struct proto_tessellation *out, struct proto_problem *problem)
{
    static const char *const members[] = {"mesh", "tolerance", "resolution", NULL};
    struct proto_tessellation wanted = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    bool has_tolerance = json_object_get(document, "tolerance") != NULL;
    if (has_tolerance == (json_object_get(document, "resolution") != NULL))
        return proto_problem_refuse(problem, "",
                                    "say either tolerance or resolution, the cells in u and in v");
    if (!proto_made_mesh_decode(document, wanted.mesh, problem)) return false;
    if (has_tolerance ? !decode_tolerance(document, &wanted.options, problem)
                      : !decode_resolution(document, max_faces, &wanted.options, problem))
        return false;
    *out = wanted;
    return true;
}

/* --- the vertices ----------------------------------------------------------------------------- */

static void encode_periods(struct proto_writer *writer, const double period[2])
{
    proto_write_key(writer, "periods");
    proto_write_array_begin(writer);
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
        proto_write_key(writer, "uv");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < parameters->count; i++)
            proto_write_numbers(writer, parameters->uv[i], 2);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
