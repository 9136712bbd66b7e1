/* Field values: what a field says of vertices, of points and of edges. */
#include "server/query/handlers.h"

#include <endian.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/field.h"
#include "server/query/evaluation.h"
#include "server/query/field_query.h"
#include "server/query/result.h"
#include "server/http/reply.h"

#define QUICK_VERTICES 10000 /* as many as an HTTP thread may write */
#define WHAT           "the answer"

/* --- of all vertices -------------------------------------------------------------------------- */

struct values {
    struct server_field_query field; /* first */
    double *values;                  /* by index; what is not finite is null */
};

static uint32_t value_count(const struct server_query *query)
{
    return gd_mesh_summary(query->surface->mesh)->index_count;
}

static enum gd_status reserve_values(struct values *values)
{
    size_t count = value_count(&values->field.query);
    enum gd_status status = server_query_take(&values->field.query, count * sizeof *values->values);
    if (status) return status;
    values->values = malloc(count * sizeof *values->values);
    return values->values ? GD_OK : GD_NO_MEMORY;
}

static enum server_query_turn answer_values(struct server_field_query *query,
                                            const struct gd_field *field,
                                            struct server_monitor *part,
                                            struct proto_problem *problem)
{
    struct values *values = (struct values *)query;
    double most = query->request.radius;
    enum gd_status status = reserve_values(values);
    (void)part;
    if (status) return server_query_fail(&query->query, status, WHAT, problem);
    gd_field_vertex_distances(field, values->values);
    for (uint32_t i = 0; i < value_count(&query->query) && most > 0; i++)
        if (values->values[i] > most) values->values[i] = INFINITY;
    return SERVER_QUERY_DONE;
}

static bool parse_values(struct server_query *query, const struct proto_parameters *parameters,
                         struct proto_problem *problem)
{
    struct server_field_query *field = (struct server_field_query *)query;
    (void)parameters;
    field->answer = answer_values;
    field->is_quick = value_count(query) <= QUICK_VERTICES && query->form < SERVER_FORM_FIRST;
    return server_field_query_of_resource(field, problem);
}

static void encode_values(const struct server_query *query, struct proto_writer *writer)
{
    proto_values_encode(writer, ((const struct values *)query)->values, value_count(query));
}

/* Little-endian, NaN for null. */
static size_t values_as_bytes(const struct server_query *query, void *out)
{
    const struct values *values = (const struct values *)query;
    uint32_t count = value_count(query);
    uint64_t *bytes = out;
    for (uint32_t i = 0; i < count && bytes; i++) {
        double value = isfinite(values->values[i]) ? values->values[i] : NAN;
        memcpy(&bytes[i], &value, sizeof value);
        bytes[i] = htole64(bytes[i]);
    }
    return count * sizeof *bytes;
}

/* The distances with the mesh that they are the distances on, which is always there. */
static const struct server_form value_forms[] = {{"ply", "application/x-ply", false},
                                                 {"glb", "model/gltf-binary", false},
                                                 {"csv", "text/csv", false},
                                                 {NULL, NULL, false}};
static const enum gd_result_format value_formats[] = {GD_RESULT_PLY, GD_RESULT_GLB, GD_RESULT_CSV};

static bool write_values(const struct server_query *query, char **bytes, size_t *size,
                         struct proto_problem *problem)
{
    const struct gd_result result = {.distances = ((const struct values *)query)->values};
    return server_result_write(query, &result, true, value_formats[query->form - SERVER_FORM_FIRST],
                               bytes, size, problem);
}

static void release_values(struct server_query *query)
{
    free(((struct values *)query)->values);
    server_field_query_release(query);
}

static const struct server_query_kind values_kind = {.name = "values",
                                                     .size = sizeof(struct values),
                                                     .fields = proto_values_fields,
                                                     .parse = parse_values,
                                                     .glance = server_field_query_glance,
                                                     .join = server_field_query_join,
                                                     .solve = server_field_query_solve,
                                                     .encode = encode_values,
                                                     .bytes = values_as_bytes,
                                                     .forms = value_forms,
                                                     .write = write_values,
                                                     .release = release_values};

void server_handle_get_field_values(struct server_exchange *exchange)
{
    server_query_handle(exchange, &values_kind);
}

/* --- of points -------------------------------------------------------------------------------- */

static bool decode_points(struct server_query *query, const json_t *document,
                          struct proto_problem *problem)
{
    struct server_evaluation *evaluation = (struct server_evaluation *)query;
    struct proto_evaluation wanted;
    if (!server_field_query_of_resource(&evaluation->field, problem)) return false;
    if (!proto_evaluation_decode(document, &wanted, problem)) return false;
    bool ok = server_evaluation_locate(evaluation, &wanted, problem);
    proto_evaluation_free(&wanted);
    return ok;
}

static const struct server_query_kind evaluate_kind = {.name = "evaluate",
                                                       .size = sizeof(struct server_evaluation),
                                                       .fields = proto_evaluation_fields,
                                                       .decode = decode_points,
                                                       .glance = server_field_query_glance,
                                                       .join = server_field_query_join,
                                                       .solve = server_field_query_solve,
                                                       .release = server_evaluation_release};

void server_handle_evaluate_field(struct server_exchange *exchange)
{
    server_query_handle(exchange, &evaluate_kind);
}

/* --- of an edge ------------------------------------------------------------------------------- */

struct edge {
    struct server_field_query field; /* first */
    struct gd_vertex ends[2];
    struct gd_wedge *wedges; /* owned */
    uint32_t count;
};

/* A curve has a seed for each of its points and segments. */
static void name_members(struct edge *edge)
{
    for (uint32_t i = 0; i < edge->count; i++)
        if (!edge->wedges[i].at_vertex)
            edge->wedges[i].source = edge->field.set->members[edge->wedges[i].source];
}

static enum server_query_turn answer_edge(struct server_field_query *query,
                                          const struct gd_field *field, struct server_monitor *part,
                                          struct proto_problem *problem)
{
    struct edge *edge = (struct edge *)query;
    (void)part;
    enum gd_status status =
        gd_field_wedges(field, edge->ends[0], edge->ends[1], &edge->wedges, &edge->count);
    if (!status) {
        name_members(edge);
        return SERVER_QUERY_DONE;
    }
    server_query_fail(&query->query, status, WHAT, problem);
    if (status == GD_NO_SUCH_EDGE) proto_problem_at(problem, "edge");
    return SERVER_QUERY_FAILED;
}

static bool parse_edge(struct server_query *query, const struct proto_parameters *parameters,
                       struct proto_problem *problem)
{
    struct edge *edge = (struct edge *)query;
    edge->field.answer = answer_edge;
    edge->field.is_quick = true;
    return server_field_query_of_resource(&edge->field, problem) &&
           proto_wedges_parse(parameters, edge->ends, problem);
}

static void encode_edge(const struct server_query *query, struct proto_writer *writer)
{
    const struct edge *edge = (const struct edge *)query;
    proto_wedges_encode(writer, edge->ends, edge->wedges, edge->count, query->options.fields);
}

static void release_edge(struct server_query *query)
{
    free(((struct edge *)query)->wedges);
    server_field_query_release(query);
}

static const struct server_query_kind wedges_kind = {.name = "wedges",
                                                     .size = sizeof(struct edge),
                                                     .fields = proto_wedges_fields,
                                                     .parameters = proto_wedges_parameters,
                                                     .parse = parse_edge,
                                                     .glance = server_field_query_glance,
                                                     .join = server_field_query_join,
                                                     .solve = server_field_query_solve,
                                                     .encode = encode_edge,
                                                     .release = release_edge};

void server_handle_get_field_wedges(struct server_exchange *exchange)
{
    server_query_handle(exchange, &wedges_kind);
}
