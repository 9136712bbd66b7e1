/* Answers queries for lines where two paths from a set are equally long: the Voronoi diagram of the
 * set's members, and the cut locus of the set (of a point, or the medial axis of a curve). */
#include "server/query/handlers.h"

#include "gd/curve.h"
#include "gd/cut_locus.h"
#include "generated/queries.h"
#include "proto/json/writer.h"
#include "proto/queries/isoline.h"
#include "proto/values/path.h"
#include "server/query/query.h"
#include "server/query/result.h"
#include "server/work/executor.h"

#define BYTES_A_TRACE ((size_t)1 << 20)
#define LINE_POINTS   500000 /* limit on the points of an answer */
#define CORNER        1e-6   /* a curve has a corner where it turns by more than this, in radians */

/* --- lines ------------------------------------------------------------------------------------ */

struct lines_query {
    struct server_query query; /* must be the first member */
    struct gd_voronoi found;
    struct gd_path *paths; /* a path for each line; its points are in `found` */
};

/* The constants of a kind of query (`own`). */
struct tracer {
    const char *what, *noun, *advice; /* parts of the sentences of problems */
    size_t bytes_an_edge;             /* memory for each edge of the mesh while lines are traced */
    size_t bytes_a_wedge;             /* the same for each wedge of the field */
    enum gd_status (*trace)(struct lines_query *own, const struct gd_field *field,
                            const uint32_t *members, const struct gd_control *control);
};

static bool lines_admit(const struct lines_query *own, const struct tracer *tracer)
{
    uint64_t points = 0;
    for (uint32_t i = 0; i < own->found.bisector_count; i++)
        points += own->found.bisectors[i].point_count;
    bool has_points =
        own->query.form >= SERVER_FORM_FIRST || own->query.options.geometry != PROTO_GEOMETRY_NONE;
    return !has_points || points <= LINE_POINTS ||
           proto_problem_exceed(own->query.problem, NULL, LINE_POINTS,
                                "the %s have %llu points, more than %d; ask for %s, or "
                                "geometry=none",
                                tracer->noun, (unsigned long long)points, LINE_POINTS,
                                tracer->advice);
}

static enum gd_status paths_list(struct lines_query *own)
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

/* Traces the lines. `members` has the member of each seed. */
static enum server_query_turn lines_trace(struct lines_query *own, const struct gd_field *field,
                                          const uint32_t *members)
{
    struct server_query *query = &own->query;
    const struct tracer *tracer = query->kind->own;
    const struct gd_mesh_summary *summary = gd_mesh_summary(query->surface->mesh);
    size_t bytes = BYTES_A_TRACE + summary->edges * tracer->bytes_an_edge +
                   gd_field_statistics(field)->wedges * tracer->bytes_a_wedge;
    struct server_budgeted_call call = server_query_begin_call(query, NULL, bytes);
    call.control.executor = server_executor_start_for(
        query->exchange->host->workers, summary->faces, query->exchange->job.deadline_ns);
    while (server_budgeted_call_next(&call)) {
        call.status = tracer->trace(own, field, members, &call.control);
        call.kept = own->found.bytes;
    }
    server_executor_stop(call.control.executor);
    enum gd_status status = call.status;
    if (!status && !lines_admit(own, tracer)) return SERVER_QUERY_FAILED;
    if (!status) status = paths_list(own);
    return server_query_end_draft(query, status, tracer->what);
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

static void lines_encode(const struct lines_query *own, struct proto_writer *writer)
{
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < own->found.bisector_count; i++)
        line_encode(&own->query, writer, &own->found.bisectors[i]);
    proto_write_array_end(writer);
}

static bool lines_list_arrays(struct server_query *query)
{
    struct lines_query *own = (struct lines_query *)query;
    const struct gd_bisector *lines = own->found.bisectors;
    uint32_t count = own->found.bisector_count;
    if (!server_query_list_lines(query, own->paths, sizeof *own->paths, count)) return false;
    server_arrays_add(&query->arrays, &(struct server_array){.name = "members",
                                                             .type = SERVER_ARRAY_INDICES,
                                                             .columns = 2,
                                                             .rows = count,
                                                             .source = lines,
                                                             .stride = sizeof *lines});
    server_arrays_add_member(&query->arrays, "length", count,
                             own->paths ? &own->paths->length : NULL, sizeof *own->paths);
    return true;
}

static void lines_release(struct server_query *query)
{
    gd_voronoi_free(&((struct lines_query *)query)->found);
}

/* --- cut locus -------------------------------------------------------------------------------- */

struct cut_locus_query {
    struct lines_query lines; /* must be the first member */
    unsigned members;         /* PROTO_MEMBERS_… */
    struct gd_cut_locus_options options;
};

static void cut_locus_choose(struct server_query *query, unsigned members, double tolerance,
                             double min_angle)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    own->members = members;
    own->options = (struct gd_cut_locus_options){
        proto_isolines_tolerance(tolerance, query->surface->mesh), min_angle};
}

static bool cut_locus_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct proto_get_cut_locus_query wanted;
    if (!server_field_query_of_resource(query) ||
        !proto_get_cut_locus_query_parse(parameters, &wanted, query->problem))
        return false;
    if (query->field.request.radius > 0)
        return proto_problem_set(query->problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "the field ends at its max_distance, but a cut locus needs all "
                                 "distances; send the set to POST /v1/meshes/{name}/cut-locus");
    cut_locus_choose(query, wanted.members, wanted.has_tolerance ? wanted.tolerance : 0,
                     wanted.has_min_angle ? wanted.min_angle : 0);
    return true;
}

static bool cut_locus_decode(struct server_query *query, const json_t *document)
{
    struct proto_cut_locus_request wanted;
    if (!proto_cut_locus_request_decode(document, &wanted, query->problem)) return false;
    cut_locus_choose(query, wanted.members, wanted.tolerance, wanted.min_angle);
    return server_field_query_of_set(query, &wanted.set, 0);
}

/* Sets *out to the member of each seed. */
static enum gd_status members_find(struct cut_locus_query *own, const uint32_t **out)
{
    struct server_query *query = &own->lines.query;
    const struct proto_located_set *set = query->field.set;
    if (own->members == PROTO_MEMBERS_SOURCES) {
        *out = set->members;
        return GD_OK;
    }
    uint32_t *parts = server_query_allocate(query, set->seed_count, sizeof *parts);
    if (!parts) return GD_BUDGET;
    gd_curve_parts(query->surface->mesh, set->seeds, set->seed_count, CORNER, parts);
    *out = parts;
    return GD_OK;
}

static enum gd_status cut_locus_trace(struct lines_query *own, const struct gd_field *field,
                                      const uint32_t *members, const struct gd_control *control)
{
    return gd_cut_locus_trace(field, members, &((struct cut_locus_query *)own)->options, control,
                              &own->found);
}

static const struct tracer cut_locus_tracer = {.what = "the cut locus",
                                               .noun = "lines",
                                               .advice = "a larger min_angle or tolerance",
                                               /* about one ridge for each wedge */
                                               .bytes_an_edge = 16,
                                               .bytes_a_wedge = 160,
                                               .trace = cut_locus_trace};

static enum server_query_turn cut_locus_answer(struct server_query *query,
                                               const struct gd_field *field)
{
    struct cut_locus_query *own = (struct cut_locus_query *)query;
    const uint32_t *members;
    if (!(query->options.fields & PROTO_CUT_LOCUS_FIELD_LINES))
        return server_query_end_draft(query, GD_OK, cut_locus_tracer.what);
    enum gd_status status = members_find(own, &members);
    if (status) return server_query_fail(query, status, cut_locus_tracer.what);
    return lines_trace(&own->lines, field, members);
}

static void cut_locus_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_write_object_begin(writer);
    if (proto_field(writer, &query->options, PROTO_CUT_LOCUS_FIELD_LINES))
        lines_encode((const struct lines_query *)query, writer);
    proto_write_object_end(writer);
}

const struct server_query_kind server_query_cut_locus = {.name = "cut-locus",
                                                         .size = sizeof(struct cut_locus_query),
                                                         .own = &cut_locus_tracer,
                                                         .forms = server_result_line_forms,
                                                         .write = server_result_write_listed,
                                                         .has_bare_points = true,
                                                         .decode = cut_locus_decode,
                                                         .parse = cut_locus_parse,
                                                         .answer = cut_locus_answer,
                                                         .encode = cut_locus_encode,
                                                         .list_arrays = lines_list_arrays,
                                                         .release = lines_release};

/* --- Voronoi diagram -------------------------------------------------------------------------- */

struct voronoi_query {
    struct lines_query lines; /* must be the first member */
    double tolerance;
    uint32_t *labels; /* by vertex index; NULL if not selected */
};

static bool voronoi_decode(struct server_query *query, const json_t *document)
{
    struct proto_voronoi_request wanted;
    if (!proto_voronoi_request_decode(document, &wanted, query->problem)) return false;
    ((struct voronoi_query *)query)->tolerance =
        proto_isolines_tolerance(wanted.tolerance, query->surface->mesh);
    return server_field_query_of_set(query, &wanted.set, 0);
}

/* Computes the labels. Meanwhile, the engine needs as many additional bytes as the labels have. */
static enum gd_status labels_find(struct voronoi_query *own, const struct gd_field *field)
{
    struct server_query *query = &own->lines.query;
    size_t count = gd_mesh_summary(query->surface->mesh)->index_count,
           bytes = count * sizeof *own->labels;
    own->labels = server_query_allocate(query, count, sizeof *own->labels);
    enum gd_status status = own->labels ? server_query_take(query, bytes) : GD_BUDGET;
    if (status) return status;
    status = gd_voronoi_labels(field, query->field.set->members, own->labels);
    server_query_give(query, bytes);
    return status;
}

static enum gd_status voronoi_trace(struct lines_query *own, const struct gd_field *field,
                                    const uint32_t *members, const struct gd_control *control)
{
    return gd_voronoi_trace(field, members, ((struct voronoi_query *)own)->tolerance, control,
                            &own->found);
}

static const struct tracer voronoi_tracer = {.what = "the diagram",
                                             .noun = "bisectors",
                                             .advice = "a larger tolerance, fewer members",
                                             .bytes_an_edge = 48,
                                             .trace = voronoi_trace};

static enum server_query_turn voronoi_answer(struct server_query *query,
                                             const struct gd_field *field)
{
    struct voronoi_query *own = (struct voronoi_query *)query;
    uint32_t fields = query->options.fields;
    enum gd_status status = fields & PROTO_VORONOI_FIELD_LABELS ? labels_find(own, field) : GD_OK;
    if (status || !(fields & PROTO_VORONOI_FIELD_BISECTORS))
        return server_query_end_draft(query, status, voronoi_tracer.what);
    return lines_trace(&own->lines, field, query->field.set->members);
}

static void voronoi_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct voronoi_query *own = (const struct voronoi_query *)query;
    uint32_t count = gd_mesh_summary(query->surface->mesh)->index_count;
    proto_write_object_begin(writer);
    if (own->labels) proto_member_indices(writer, "labels", own->labels, count);
    if (proto_field(writer, &query->options, PROTO_VORONOI_FIELD_BISECTORS))
        lines_encode(&own->lines, writer);
    proto_write_object_end(writer);
}

static bool voronoi_list_arrays(struct server_query *query)
{
    struct voronoi_query *own = (struct voronoi_query *)query;
    if (own->labels)
        server_arrays_add_indices(&query->arrays, "labels", 0,
                                  gd_mesh_summary(query->surface->mesh)->index_count, own->labels);
    return !(query->options.fields & PROTO_VORONOI_FIELD_BISECTORS) || lines_list_arrays(query);
}

const struct server_query_kind server_query_voronoi = {.name = "voronoi",
                                                       .size = sizeof(struct voronoi_query),
                                                       .own = &voronoi_tracer,
                                                       .forms = server_result_line_forms,
                                                       .write = server_result_write_listed,
                                                       .decode = voronoi_decode,
                                                       .answer = voronoi_answer,
                                                       .encode = voronoi_encode,
                                                       .has_bare_points = true,
                                                       .list_arrays = voronoi_list_arrays,
                                                       .release = lines_release};
