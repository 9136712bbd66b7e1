/* Shortest paths on NURBS surfaces: between two points, a point and a curve, two curves; by a
 * worker. */
#include "server/query/handlers.h"

#include "proto/geodesic_like.h"
#include "server/query/query.h"
#include "server/surfaces/kinds.h"

#define BYTES_A_FACE 1024 /* of the tessellation: two fields, and the ways that are followed */
#define BYTES_A_PATH ((size_t)1 << 20)
#define WHAT         "the search for the path"

struct finding {
    struct server_query query; /* first */
    struct proto_geodesic wanted;
    struct gd_domain_curve *ends[2];
    struct server_monitor monitor;
    struct gd_geodesics found;
    struct gd_detail detail;
};

/* --- the question ----------------------------------------------------------------------------- */

/* Why there are no paths on this surface. */
static bool refuse_surface(const struct server_nurbs *nurbs, struct proto_problem *problem)
{
    const char *why =
        nurbs->detail.text[0] ? nurbs->detail.text : gd_status_sentence(nurbs->refusal);
    proto_problem_set(
        problem, PROTO_PROBLEM_INVALID_MESH,
        "shortest paths are first looked for on a tessellation, and this surface has none: %s",
        why);
    problem->reason = gd_status_name(nurbs->refusal);
    return false;
}

static bool decode(struct server_query *query, const json_t *document,
                   const struct proto_geodesic_form *form, struct proto_problem *problem)
{
    const struct server_nurbs *nurbs = server_nurbs_of(query->surface);
    if (!nurbs->tessellation) return refuse_surface(nurbs, problem);
    return proto_geodesic_decode(document, form, &((struct finding *)query)->wanted, problem);
}

static bool decode_points(struct server_query *query, const json_t *document,
                          struct proto_problem *problem)
{
    return decode(query, document, &proto_geodesic_between_points, problem);
}

static bool decode_point_and_curve(struct server_query *query, const json_t *document,
                                   struct proto_problem *problem)
{
    return decode(query, document, &proto_geodesic_to_curve, problem);
}

static bool decode_curves(struct server_query *query, const json_t *document,
                          struct proto_problem *problem)
{
    return decode(query, document, &proto_geodesic_between_curves, problem);
}

/* --- the answer ------------------------------------------------------------------------------- */

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

static enum gd_status find(void *user, const struct gd_control *control, size_t *kept)
{
    struct finding *finding = user;
    const struct gd_tessellation *tessellation =
        server_nurbs_of(finding->query.surface)->tessellation;
    enum gd_status status =
        gd_geodesic_solve(tessellation, finding->ends[0], finding->ends[1],
                          &finding->wanted.options, control, &finding->found, &finding->detail);
    if (!status) *kept = found_bytes(&finding->found);
    return status;
}

static enum gd_status find_paths(struct finding *finding)
{
    struct server_query *query = &finding->query;
    const struct gd_mesh *mesh =
        gd_tessellation_mesh(server_nurbs_of(query->surface)->tessellation);
    finding->monitor = server_query_monitor(query, 0, 1);
    return server_query_call(query, &finding->monitor, find, finding,
                             BYTES_A_PATH + gd_mesh_summary(mesh)->faces * (size_t)BYTES_A_FACE);
}

/* Long curves take tens of milliseconds each. */
static bool locate_ends(struct finding *finding, struct proto_problem *problem)
{
    const struct gd_parametric *surface = server_nurbs_of(finding->query.surface)->surface;
    finding->monitor = server_query_monitor(&finding->query, 0, 1);
    const struct gd_control control = server_exchange_control(&finding->monitor);
    for (int k = 0; k < 2; k++) {
        const struct proto_domain_curve *wanted = &finding->wanted.ends[k];
        bool located =
            proto_domain_curve_locate(surface, wanted, &control, &finding->ends[k], problem);
        enum gd_status status = gd_control_check(&control, 0);
        if (status)
            return server_query_fail(&finding->query, status, WHAT, problem) == SERVER_QUERY_DONE;
        if (!located) return false;
    }
    return true;
}

static enum gd_status write_answer(struct finding *finding)
{
    const struct proto_geodesic_answer answer = {.request = &finding->wanted,
                                                 .ends = {finding->ends[0], finding->ends[1]},
                                                 .found = &finding->found};
    return proto_geodesic_encode(&finding->query.draft, &answer, &finding->query.options);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct finding *finding = (struct finding *)query;
    if (!locate_ends(finding, problem)) return SERVER_QUERY_FAILED;
    enum gd_status status = find_paths(finding);
    if (status == GD_INVALID_ARGUMENT) {
        proto_problem_from_status(problem, status, &finding->detail);
        return SERVER_QUERY_FAILED;
    }
    if (status) return server_query_fail(query, status, WHAT, problem);
    return server_query_end_draft(query, write_answer(finding), "the answer", problem);
}

static void release(struct server_query *query)
{
    struct finding *finding = (struct finding *)query;
    gd_geodesics_free(&finding->found);
    for (int k = 0; k < 2; k++) gd_domain_curve_release(finding->ends[k]);
    proto_geodesic_free(&finding->wanted);
}

/* --- the three questions ---------------------------------------------------------------------- */

static const struct server_query_kind geodesic_kind = {.name = "geodesic",
                                                       .size = sizeof(struct finding),
                                                       .fields = proto_geodesic_fields,
                                                       .decode = decode_points,
                                                       .solve = solve,
                                                       .release = release};

static const struct server_query_kind point_curve_kind = {.name = "point-curve-distance",
                                                          .size = sizeof(struct finding),
                                                          .fields = proto_geodesic_fields,
                                                          .decode = decode_point_and_curve,
                                                          .solve = solve,
                                                          .release = release};

static const struct server_query_kind curves_kind = {.name = "curve-distance",
                                                     .size = sizeof(struct finding),
                                                     .fields = proto_geodesic_fields,
                                                     .decode = decode_curves,
                                                     .solve = solve,
                                                     .release = release};

void server_handle_nurbs_geodesic(struct server_exchange *exchange)
{
    server_query_handle(exchange, &geodesic_kind);
}

void server_handle_nurbs_point_curve_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &point_curve_kind);
}

void server_handle_nurbs_curve_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &curves_kind);
}
