#include "proto/queries/subdivision.h"

#include "generated/queries.h"
#include "proto/values/usd.h"

bool proto_subdivision_options_parse(const struct proto_parameters *parameters,
                                     struct proto_subdivision_options *out,
                                     struct proto_problem *problem)
{
    struct proto_create_subdivision_query query;
    if (!proto_parameters_check(parameters, proto_create_subdivision_parameters, problem) ||
        !proto_create_subdivision_query_parse(parameters, &query, problem))
        return false;
    *out = (struct proto_subdivision_options){
        .format = query.has_format ? gd_format_by_name(proto_upload_format_words[query.format])
                                   : GD_FORMAT_ANY,
        .has_scheme = proto_parameters_get(parameters, "scheme") != NULL,
        .scheme = (enum gd_scheme)query.scheme};
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
    proto_problem_from_status(&flaw, GD_INDEX, detail); /* with the elements of `detail` */
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

void proto_subdivision_encode_extraordinary_vertices(
    struct proto_writer *writer, const struct proto_subdivision_description *description)
{
    const struct gd_subdivision_summary *summary = &description->summary;
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < summary->extraordinary_count; i++) {
        proto_write_object_begin(writer);
        proto_member_uint(writer, "valence", summary->extraordinary[i].valence);
        proto_member_uint(writer, "count", summary->extraordinary[i].count);
        proto_write_object_end(writer);
    }
    proto_write_array_end(writer);
}
