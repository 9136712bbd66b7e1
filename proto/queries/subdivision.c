#include "proto/queries/subdivision.h"

#include "gd/limit_mesh.h"
#include "proto/json/decode.h"
#include "proto/json/writer.h"
#include "proto/values/usd.h"

bool proto_subdivision_options_parse(const struct proto_parameters *parameters,
                                     struct proto_subdivision_options *out,
                                     struct proto_problem *problem)
{
    unsigned format = 0, scheme = GD_SCHEME_CATMULL_CLARK;
    if (!proto_parameters_check(parameters, proto_create_subdivision_parameters, problem) ||
        !proto_parameters_choice(parameters, "format", proto_upload_format_words, &format,
                                 problem) ||
        !proto_parameters_choice(parameters, "scheme", proto_scheme_words, &scheme, problem))
        return false;
    bool has_format = proto_parameters_get(parameters, "format") != NULL;
    *out = (struct proto_subdivision_options){
        .format = has_format ? gd_format_by_name(proto_upload_format_words[format]) : GD_FORMAT_ANY,
        .has_scheme = proto_parameters_get(parameters, "scheme") != NULL,
        .scheme = (enum gd_scheme)scheme};
    return true;
}

/* --- the file --------------------------------------------------------------------------------- */

bool proto_subdivision_refuse(enum gd_status status, const struct gd_detail *detail,
                              struct proto_problem *problem)
{
    bool is_flaw = status == GD_OUT_OF_RANGE || status == GD_NO_SUCH_EDGE ||
                   status == GD_UNREFERENCED_VERTEX || status == GD_INVALID_ARGUMENT;
    proto_problem_from_status(problem, status, detail);
    if (!is_flaw) return false;
    struct proto_problem flaw;
    proto_problem_from_status(&flaw, GD_INDEX, detail); /* with the elements, as for any file */
    flaw.reason = gd_status_name(status);
    *problem = flaw;
    return false;
}

static bool settle_scheme(const struct proto_subdivision_options *options,
                          const struct proto_usd *usd, enum gd_scheme *out,
                          struct proto_problem *problem)
{
    if (usd->has_scheme && options->has_scheme && usd->scheme != options->scheme)
        return proto_problem_refuse(
            problem, "/subdivisionScheme",
            "the file's scheme is %s, and the query string says %s; say one of them",
            proto_scheme_words[usd->scheme], proto_scheme_words[options->scheme]);
    *out = usd->has_scheme ? usd->scheme : options->scheme;
    return true;
}

bool proto_subdivision_read(const void *bytes, size_t size,
                            const struct proto_subdivision_options *options,
                            const struct gd_read_options *limits, struct gd_control_mesh *out,
                            enum gd_scheme *scheme, struct proto_problem *problem)
{
    struct proto_usd usd = {0};
    if (options->format == GD_FORMAT_JSON && proto_usd_is(bytes, size)) {
        if (!proto_usd_read(bytes, size, limits, &usd, problem)) return false;
    } else {
        struct gd_detail detail = {0};
        struct gd_read_options own = limits ? *limits : (struct gd_read_options){0};
        own.format = options->format;
        enum gd_status status = gd_read_control_mesh(bytes, size, &own, &usd.control_mesh, &detail);
        if (status) return proto_subdivision_refuse(status, &detail, problem);
    }
    if (!settle_scheme(options, &usd, scheme, problem)) {
        gd_control_mesh_free(&usd.control_mesh);
        return false;
    }
    *out = usd.control_mesh;
    return true;
}

/* --- the description -------------------------------------------------------------------------- */

static void encode_extraordinary(struct proto_writer *writer,
                                 const struct gd_subdivision_summary *summary)
{
    proto_member_array(writer, "extraordinary_vertices");
    for (uint32_t i = 0; i < summary->extraordinary_count; i++) {
        proto_write_object_begin(writer);
        proto_member_uint(writer, "valence", summary->extraordinary[i].valence);
        proto_member_uint(writer, "count", summary->extraordinary[i].count);
        proto_write_object_end(writer);
    }
    proto_write_array_end(writer);
}

static void encode_control_mesh(struct proto_writer *writer, const struct gd_subdivision *surface)
{
    const struct gd_subdivision_summary summary = gd_subdivision_summary(surface);
    proto_member_string(writer, "scheme", proto_scheme_words[gd_subdivision_scheme(surface)]);
    proto_member_uint(writer, "vertices", summary.vertex_count);
    proto_member_uint(writer, "edges", summary.edge_count);
    proto_member_uint(writer, "faces", summary.face_count);
    encode_extraordinary(writer, &summary);
    proto_member_uint(writer, "crease_edges", summary.crease_edges);
    proto_member_uint(writer, "corner_vertices", summary.corner_vertices);
    proto_member_uint(writer, "boundary_edges", summary.boundary_edges);
    proto_member_uint(writer, "boundaries", summary.boundary_loops);
    proto_member_uint(writer, "least_level", gd_limit_mesh_least_level(surface));
    proto_member_uint(writer, "usual_level", gd_limit_mesh_usual_level(surface));
}

void proto_subdivision_encode(struct proto_writer *writer,
                              const struct proto_subdivision_description *description)
{
    proto_write_object_begin(writer);
    proto_member_string(writer, "name", description->name);
    proto_member_string(writer, "sha256", description->sha256);
    encode_control_mesh(writer, description->surface);
    proto_member_uint(writer, "memory_bytes", description->memory_bytes);
    proto_member_time(writer, "created", description->created);
    proto_member_string(writer, "etag", description->etag);
    proto_write_object_end(writer);
}
