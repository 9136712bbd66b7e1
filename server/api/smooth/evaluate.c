/* Evaluate and nearest on smooth surfaces: position and derivatives at many places, and the place
 * nearest to a point of space. Each has one flow and, for each kind of surface, its steps. */
#include "server/api/smooth/smooth.h"

#include "proto/json/member.h"
#include "proto/queries/jet.h"
#include "server/query/api.h"
#include "server/query/handlers.h"
#include "server/surfaces/kinds.h"

#define NEAREST_BYTES ((size_t)1 << 20)

enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what,
                                          struct proto_problem *problem)
{
    if (status == GD_BUDGET || !detail->text[0])
        return server_query_fail(query, status, what, problem);
    if (status == GD_INTERNAL) status = GD_DEGENERATE_FACE;
    proto_problem_from_status(problem, status, detail);
    if (status == GD_TOO_LARGE)
        proto_problem_limit(problem, query->exchange->host->api->config->max_faces);
    return SERVER_QUERY_FAILED;
}

static const struct gd_parametric *nurbs_of(const struct server_query *query)
{
    return server_nurbs_of(query->surface)->surface;
}

static const struct gd_subdivision *subdivision_of(const struct server_query *query)
{
    return server_subdivision_of(query->surface)->surface;
}

/* --- evaluate: {"points": [one per place]} ---------------------------------------------------- */

enum { LIMIT_ROUND = 256 };

struct evaluation;

struct evaluator {
    struct server_query_kind kind; /* first */
    uint32_t quick;                /* so many places are evaluated in the HTTP thread */
    uint32_t round;                /* places between two checks of clock and budget */
    enum gd_status (*write)(struct evaluation *evaluation, uint32_t first, uint32_t count,
                            const struct gd_control *control);
};

struct evaluation {
    struct server_query query; /* first */
    union {
        struct proto_uvs nurbs;
        struct proto_limit_places limit;
    } places;
    uint32_t count;
    struct gd_detail detail; /* of a failure */
};

static const struct evaluator *evaluator_of(const struct server_query *query)
{
    return (const struct evaluator *)query->kind;
}

static enum gd_status evaluation_write_round(struct evaluation *evaluation, uint32_t first)
{
    const struct evaluator *by = evaluator_of(&evaluation->query);
    uint32_t total = evaluation->count, left = total - first,
             count = left < by->round ? left : by->round;
    struct server_monitor monitor =
        server_query_monitor(&evaluation->query, (double)first / total, (double)count / total);
    const struct gd_control control = server_exchange_control(&monitor);
    enum gd_status status = by->write(evaluation, first, count, &control);
    if (!status) status = server_query_pause(&evaluation->query, NULL, 0);
    return status ? status : gd_control_check(&control, 1);
}

static enum server_query_turn evaluation_solve(struct server_query *query,
                                               struct proto_problem *problem)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_writer *writer = &query->draft;
    enum gd_status status = GD_OK;
    proto_write_object_begin(writer);
    proto_member_array(writer, "points");
    for (uint32_t i = 0; i < evaluation->count && !status; i += evaluator_of(query)->round)
        status = evaluation_write_round(evaluation, i);
    proto_write_array_end(writer);
    proto_write_object_end(writer);
    if (status)
        return server_smooth_fail(query, status, &evaluation->detail, "the answer", problem);
    return server_query_end_draft(query, GD_OK, "the answer", problem);
}

static enum server_query_turn evaluation_glance(struct server_query *query,
                                                struct proto_problem *problem)
{
    if (((struct evaluation *)query)->count > evaluator_of(query)->quick) return SERVER_QUERY_AGAIN;
    return evaluation_solve(query, problem);
}

#define EVALUATION_STEPS                                                                           \
    .name = "evaluate", .size = sizeof(struct evaluation), .glance = evaluation_glance,            \
    .solve = evaluation_solve

static enum gd_status nurbs_write(struct evaluation *evaluation, uint32_t first, uint32_t count,
                                  const struct gd_control *control)
{
    struct server_query *query = &evaluation->query;
    enum gd_status status = GD_OK;
    (void)control; /* a round takes well below a millisecond */
    for (uint32_t i = first; i < first + count && !status; i++) {
        const double *uv = evaluation->places.nurbs.items[i];
        struct gd_jet jet;
        status = gd_parametric_evaluate(nurbs_of(query), uv[0], uv[1], &jet);
        if (!status) proto_jet_encode(&query->draft, &jet, &query->options);
    }
    return status;
}

static bool nurbs_decode(struct server_query *query, const json_t *document,
                         struct proto_problem *problem)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_uvs *places = &evaluation->places.nurbs;
    if (!proto_jets_decode(document, nurbs_of(query), places, problem)) return false;
    evaluation->count = places->count;
    return true;
}

static void nurbs_release(struct server_query *query)
{
    proto_uvs_free(&((struct evaluation *)query)->places.nurbs);
}

void server_handle_nurbs_evaluate(struct server_exchange *exchange)
{
    static const struct evaluator evaluator = {
        .kind = {.decode = nurbs_decode, .release = nurbs_release, EVALUATION_STEPS},
        .quick = 8, /* some microseconds each */
        .round = 64,
        .write = nurbs_write};
    server_query_handle(exchange, &evaluator.kind);
}

static enum gd_status limit_write(struct evaluation *evaluation, uint32_t first, uint32_t count,
                                  const struct gd_control *control)
{
    struct server_query *query = &evaluation->query;
    struct gd_limit_jet jets[LIMIT_ROUND];
    enum gd_status status = gd_limit_evaluate_many(
        subdivision_of(query),
        &(struct gd_limit_places){evaluation->places.limit.items + first, count}, control, jets,
        &evaluation->detail);
    for (uint32_t i = 0; i < count && !status; i++)
        proto_limit_jet_encode(&query->draft, &jets[i], &query->options);
    return status;
}

static bool limit_decode(struct server_query *query, const json_t *document,
                         struct proto_problem *problem)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_limit_places *places = &evaluation->places.limit;
    if (!proto_limit_jets_decode(document, subdivision_of(query), places, problem)) return false;
    evaluation->count = places->count;
    return true;
}

static void limit_release(struct server_query *query)
{
    proto_limit_places_free(&((struct evaluation *)query)->places.limit);
}

void server_handle_subdivision_evaluate(struct server_exchange *exchange)
{
    static const struct evaluator evaluator = {
        .kind = {.decode = limit_decode, .release = limit_release, EVALUATION_STEPS},
        .quick = 4, /* slower near a vertex */
        .round = LIMIT_ROUND,
        .write = limit_write};
    server_query_handle(exchange, &evaluator.kind);
}

/* --- nearest: the place nearest to {"xyz": …} ------------------------------------------------- */

struct nearest {
    struct server_query query; /* first */
    struct gd_vec3 xyz;
    union {
        struct gd_parametric_foot nurbs;
        struct gd_limit_foot limit;
    } found;
    struct gd_detail detail; /* of a failure */
};

struct finder {
    struct server_query_kind kind; /* first */
    enum gd_status (*find)(struct nearest *nearest, const struct gd_control *control);
};

static bool nearest_decode(struct server_query *query, const json_t *document,
                           struct proto_problem *problem)
{
    struct proto_foot_request wanted;
    if (!proto_foot_decode(document, &wanted, problem)) return false;
    ((struct nearest *)query)->xyz = (struct gd_vec3){wanted.xyz[0], wanted.xyz[1], wanted.xyz[2]};
    return true;
}

static enum server_query_turn nearest_solve(struct server_query *query,
                                            struct proto_problem *problem)
{
    struct nearest *nearest = (struct nearest *)query;
    const struct finder *finder = (const struct finder *)query->kind;
    struct server_budgeted_call call = server_query_begin_call(query, NULL, NEAREST_BYTES);
    while (server_budgeted_call_next(&call)) call.status = finder->find(nearest, &call.control);
    return call.status
               ? server_smooth_fail(query, call.status, &nearest->detail, "the search", problem)
               : SERVER_QUERY_DONE;
}

#define NEAREST_STEPS                                                                              \
    .name = "nearest", .size = sizeof(struct nearest), .decode = nearest_decode,                   \
    .solve = nearest_solve

static enum gd_status nurbs_find(struct nearest *nearest, const struct gd_control *control)
{
    return gd_parametric_nearest(nurbs_of(&nearest->query), nearest->xyz, control,
                                 &nearest->found.nurbs, NULL);
}

static void nurbs_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_foot_encode(writer, &((const struct nearest *)query)->found.nurbs, &query->options);
}

void server_handle_nurbs_nearest(struct server_exchange *exchange)
{
    static const struct finder finder = {{.encode = nurbs_encode, NEAREST_STEPS}, nurbs_find};
    server_query_handle(exchange, &finder.kind);
}

static enum gd_status limit_find(struct nearest *nearest, const struct gd_control *control)
{
    return gd_limit_nearest(subdivision_of(&nearest->query), nearest->xyz, control,
                            &nearest->found.limit, &nearest->detail);
}

static void limit_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_limit_foot_encode(writer, &((const struct nearest *)query)->found.limit, &query->options);
}

void server_handle_subdivision_nearest(struct server_exchange *exchange)
{
    static const struct finder finder = {{.encode = limit_encode, NEAREST_STEPS}, limit_find};
    server_query_handle(exchange, &finder.kind);
}
