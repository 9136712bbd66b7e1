/* The cut locus of a field's set: of a point, or the medial axis of a curve. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "gd/curve.h"
#include "gd/cut_locus.h"
#include "generated/queries.h"
#include "proto/json/writer.h"
#include "proto/queries/isoline.h"
#include "proto/values/path.h"
#include "server/query/query.h"
#include "server/query/result.h"

#define BYTES_A_TRACE ((size_t)1 << 20)
#define BYTES_AN_EDGE 16     /* for each edge of the mesh while ridges are traced */
#define BYTES_A_WEDGE 160    /* for each wedge; there are about as many ridges in faces */
#define LINE_POINTS   500000 /* most points of an answer */
#define CORNER        1e-6   /* radians by which a curve turns at a corner */
#define WHAT          "the cut locus"

struct cut_locus_query {
    struct server_query query; /* first */
    unsigned members;          /* PROTO_MEMBERS_… */
    struct gd_cut_locus_options options;
    struct gd_voronoi found;
    struct gd_path *paths; /* a path for each line; its points are in `found` */
};

static bool cut_locus_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    struct proto_get_cut_locus_query wanted;
    if (!server_field_query_of_resource(query) ||
        !proto_get_cut_locus_query_parse(parameters, &wanted, query->problem))
        return false;
    own->members = wanted.members;
    own->options = (struct gd_cut_locus_options){
        proto_isolines_tolerance(wanted.has_tolerance ? wanted.tolerance : 0, query->surface->mesh),
        wanted.has_min_angle ? wanted.min_angle : 0};
    return true;
}

static bool cut_locus_decode(struct server_query *query, const json_t *document)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    struct proto_cut_locus_request wanted;
    if (!proto_cut_locus_request_decode(document, &wanted, query->problem)) return false;
    own->members = wanted.members;
    own->options = (struct gd_cut_locus_options){
        proto_isolines_tolerance(wanted.tolerance, query->surface->mesh), wanted.min_angle};
    return server_field_query_of_set(query, &wanted.set, 0);
}

/* Sets *out to the member of each seed. */
static enum gd_status members_find(struct cut_locus_query *own, const uint32_t **out)
{
    const struct proto_located_set *set = own->query.field.set;
    if (own->members == PROTO_MEMBERS_SOURCES) {
        *out = set->members;
        return GD_OK;
    }
    uint32_t *parts = server_query_allocate(&own->query, set->seed_count, sizeof *parts);
    if (!parts) return GD_BUDGET;
    gd_curve_parts(own->query.surface->mesh, set->seeds, set->seed_count, CORNER, parts);
    *out = parts;
    return GD_OK;
}

static bool lines_admit(const struct cut_locus_query *own)
{
    uint64_t points = 0;
    for (uint32_t i = 0; i < own->found.bisector_count; i++)
        points += own->found.bisectors[i].point_count;
    bool has_points =
        own->query.form >= SERVER_FORM_FIRST || own->query.options.geometry != PROTO_GEOMETRY_NONE;
    if (!has_points || points <= LINE_POINTS) return true;
    return proto_problem_exceed(
        own->query.problem, NULL, LINE_POINTS,
        "the lines have %llu points, more than %d; ask for a larger min_angle or tolerance, or "
        "geometry=none",
        (unsigned long long)points, LINE_POINTS);
}

static enum gd_status paths_list(struct cut_locus_query *own)
{
    const struct gd_bisector *lines = own->found.bisectors;
    uint32_t count = own->found.bisector_count;
    own->paths = server_query_allocate(&own->query, count, sizeof *own->paths);
    if (!own->paths) return GD_BUDGET;
    for (uint32_t i = 0; i < count; i++)
        own->paths[i] = (struct gd_path){.length = lines[i].length,
                                         .points = (struct gd_point *)lines[i].points,
                                         .count = lines[i].point_count};
    return GD_OK;
}

static enum server_query_turn cut_locus_answer(struct server_query *query,
                                               const struct gd_field *field,
                                               struct server_monitor *part)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    const uint32_t *members;
    if (!(query->options.fields & PROTO_CUT_LOCUS_FIELD_LINES))
        return server_query_end_draft(query, GD_OK, WHAT);
    enum gd_status status = members_find(own, &members);
    if (status) return server_query_fail(query, status, WHAT);
    struct server_budgeted_call call = server_query_begin_call(
        query, part,
        BYTES_A_TRACE + gd_mesh_summary(query->surface->mesh)->edges * (size_t)BYTES_AN_EDGE +
            gd_field_statistics(field)->wedges * (size_t)BYTES_A_WEDGE);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_cut_locus_trace(field, members, &own->options, &call.control, &own->found);
        call.kept = own->found.bytes;
    }
    status = call.status;
    if (!status && !lines_admit(own)) return SERVER_QUERY_FAILED;
    if (!status) status = paths_list(own);
    return server_query_end_draft(query, status, WHAT);
}

static void line_encode(const struct server_query *query, struct proto_writer *writer,
                        const struct gd_bisector *line)
{
    proto_write_object_begin(writer);
    proto_member_indices(writer, "members", line->members, 2);
    proto_member_bool(writer, "closed", line->closed);
    proto_member_number(writer, "length", line->length);
    proto_member_points(writer, query->surface->mesh, line->points, line->point_count,
                        query->options.geometry);
    proto_write_object_end(writer);
}

static void cut_locus_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct cut_locus_query *own = (const struct cut_locus_query *)query;
    proto_write_object_begin(writer);
    if (proto_field(writer, &query->options, PROTO_CUT_LOCUS_FIELD_LINES)) {
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < own->found.bisector_count; i++)
            line_encode(query, writer, &own->found.bisectors[i]);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

static bool cut_locus_write(const struct server_query *query, struct server_answer_file *out)
{
    const struct cut_locus_query *own = (const struct cut_locus_query *)query;
    const struct server_result_lines lines = {.paths = own->paths,
                                              .count = own->found.bisector_count};
    if (!lines.count)
        return server_result_refuse_nothing(query->problem,
                                            "the cut locus has no lines of this angle");
    return server_result_write_lines(query, &lines, out);
}

static bool cut_locus_list_arrays(struct server_query *query)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    uint32_t count = own->found.bisector_count;
    if (!server_query_list_lines(query, own->paths, sizeof *own->paths, count)) return false;
    server_arrays_add(&query->arrays,
                      &(struct server_array){.name = "members",
                                             .type = SERVER_ARRAY_INDICES,
                                             .columns = 2,
                                             .rows = count,
                                             .source = own->found.bisectors,
                                             .stride = sizeof *own->found.bisectors});
    server_arrays_add_member(&query->arrays, "length", count,
                             own->paths ? &own->paths->length : NULL, sizeof *own->paths);
    return true;
}

static void cut_locus_release(struct server_query *query)
{
    gd_voronoi_free(&((struct cut_locus_query *)query)->found);
}

static const struct server_form cut_locus_forms[] = {SERVER_RESULT_LINE_FORMS, {NULL, NULL, false}};

const struct server_query_kind server_query_cut_locus = {.name = "cut-locus",
                                                         .size = sizeof(struct cut_locus_query),
                                                         .forms = cut_locus_forms,
                                                         .has_bare_points = true,
                                                         .decode = cut_locus_decode,
                                                         .parse = cut_locus_parse,
                                                         .answer = cut_locus_answer,
                                                         .encode = cut_locus_encode,
                                                         .write = cut_locus_write,
                                                         .list_arrays = cut_locus_list_arrays,
                                                         .release = cut_locus_release};
