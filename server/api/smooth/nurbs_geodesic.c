/* Shortest paths on NURBS surfaces, by a worker: between two points, a point and a curve, or two
 * curves. */
#include "server/query/handlers.h"

#include "proto/queries/geodesic_like.h"
#include "server/query/query.h"
#include "server/surfaces/kinds.h"

#define SEARCH_BYTES   ((size_t)1 << 20)
#define BYTES_PER_FACE 1024 /* of the tessellation: two fields, and the paths that are followed */
#define WHAT           "the search for the path"

struct search {
    struct server_query query; /* first */
    struct proto_geodesic wanted;
    struct gd_domain_curve *ends[2];
    struct gd_geodesics found;
    struct gd_detail detail;
};

struct operation {
    struct server_query_kind kind; /* first */
    const struct proto_geodesic_form *form;
};

/* A surface without a tessellation has no paths; the problem says why. */
static bool search_decode(struct server_query *query, const json_t *document,
                          struct proto_problem *problem)
{
    const struct operation *operation = (const struct operation *)query->kind;
    const struct server_nurbs *nurbs = server_nurbs_of(query->surface);
    if (nurbs->tessellation)
        return proto_geodesic_decode(document, operation->form, &((struct search *)query)->wanted,
                                     problem);
    proto_problem_set(
        problem, PROTO_PROBLEM_INVALID_MESH,
        "shortest paths are first looked for on a tessellation, and this surface has none: %s",
        nurbs->detail.text[0] ? nurbs->detail.text : gd_status_sentence(nurbs->refusal));
    problem->reason = gd_status_name(nurbs->refusal);
    return false;
}

static size_t found_bytes(const struct gd_geodesics *found)
{
    size_t bytes = found->count * sizeof *found->items;
    for (uint32_t i = 0; i < found->count; i++) {
        const struct gd_geodesic *path = &found->items[i];
        bytes += path->piece_count * sizeof *path->pieces;
        for (uint32_t k = 0; k < path->piece_count; k++)
            bytes +=
                (3 * (size_t)path->pieces[k].count + path->pieces[k].degree + 1) * sizeof(double);
    }
    return bytes;
}

/* Checks the control after each end: a long curve takes tens of milliseconds. */
static bool search_locate(struct search *search, struct server_monitor *monitor,
                          struct proto_problem *problem)
{
    const struct gd_parametric *surface = server_nurbs_of(search->query.surface)->surface;
    const struct gd_control control = server_exchange_control(monitor);
    for (int k = 0; k < 2; k++) {
        bool is_located = proto_domain_curve_locate(surface, &search->wanted.ends[k], &control,
                                                    &search->ends[k], problem);
        enum gd_status status = gd_control_check(&control, 0);
        if (status) {
            server_query_fail(&search->query, status, WHAT, problem);
            return false;
        }
        if (!is_located) return false;
    }
    return true;
}

static enum server_query_turn search_solve(struct server_query *query,
                                           struct proto_problem *problem)
{
    struct search *search = (struct search *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct gd_tessellation *tessellation = server_nurbs_of(query->surface)->tessellation;
    size_t faces = gd_mesh_summary(gd_tessellation_mesh(tessellation))->faces;
    struct server_budgeted_call call =
        server_query_begin_call(query, &monitor, SEARCH_BYTES + faces * BYTES_PER_FACE);
    if (!search_locate(search, &monitor, problem)) return SERVER_QUERY_FAILED;
    while (server_budgeted_call_next(&call)) {
        call.status = gd_geodesic_solve(
            tessellation,
            &(struct gd_geodesic_request){
                .from = search->ends[0], .to = search->ends[1], .options = &search->wanted.options},
            &call.control, &search->found, &search->detail);
        if (!call.status) call.kept = found_bytes(&search->found);
    }
    if (call.status == GD_INVALID_ARGUMENT) {
        proto_problem_from_status(problem, call.status, &search->detail);
        return SERVER_QUERY_FAILED;
    }
    if (call.status) return server_query_fail(query, call.status, WHAT, problem);
    const struct proto_geodesic_answer answer = {.request = &search->wanted,
                                                 .ends = {search->ends[0], search->ends[1]},
                                                 .found = &search->found};
    enum gd_status status = proto_geodesic_encode(&query->draft, &answer, &query->options);
    return server_query_end_draft(query, status, "the answer", problem);
}

static void search_release(struct server_query *query)
{
    struct search *search = (struct search *)query;
    gd_geodesics_free(&search->found);
    for (int k = 0; k < 2; k++) gd_domain_curve_release(search->ends[k]);
    proto_geodesic_free(&search->wanted);
}

/* --- the three operations --------------------------------------------------------------------- */

#define SEARCH_STEPS                                                                               \
    .size = sizeof(struct search), .decode = search_decode, .solve = search_solve,                 \
    .release = search_release

void server_handle_nurbs_geodesic(struct server_exchange *exchange)
{
    static const struct operation operation = {{.name = "geodesic", SEARCH_STEPS},
                                               &proto_geodesic_between_points};
    server_query_handle(exchange, &operation.kind);
}

void server_handle_nurbs_point_curve_distance(struct server_exchange *exchange)
{
    static const struct operation operation = {{.name = "point-curve-distance", SEARCH_STEPS},
                                               &proto_geodesic_to_curve};
    server_query_handle(exchange, &operation.kind);
}

void server_handle_nurbs_curve_distance(struct server_exchange *exchange)
{
    static const struct operation operation = {{.name = "curve-distance", SEARCH_STEPS},
                                               &proto_geodesic_between_curves};
    server_query_handle(exchange, &operation.kind);
}
