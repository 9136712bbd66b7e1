/* Answers the queries evaluate and nearest on smooth surfaces: position and derivatives at many
 * points, and the surface point nearest to a point in space. NURBS and subdivision surfaces have
 * the same order of steps, but their own step functions. */
#include "server/api/smooth/smooth.h"

#include <math.h>
#include <string.h>

#include "proto/json/writer.h"
#include "proto/queries/jet.h"
#include "server/query/api.h"
#include "server/query/handlers.h"
#include "server/surfaces/kinds.h"

#define NEAREST_BYTES ((size_t)1 << 20)

enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what)
{
    if (status == GD_BUDGET || !detail->text[0]) return server_query_fail(query, status, what);
    if (status == GD_INTERNAL) status = GD_DEGENERATE_FACE;
    proto_problem_from_status(query->problem, status, detail);
    if (status == GD_TOO_LARGE) {
        proto_problem_limit(query->problem, query->exchange->host->api->config->max_faces);
        proto_problem_at(query->problem,
                         server_exchange_is(query->exchange, "GET") ? "level" : "/level");
    }
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

enum { LIMIT_ROUND = 256, VECTORS = 7 };

static const char *const vector_names[VECTORS] = {"xyz", "normal", "du", "dv", "duu", "duv", "dvv"};

struct evaluation;

struct evaluator {
    uint32_t quick; /* largest number of places that an HTTP thread evaluates */
    uint32_t round; /* number of places between two checks of clock and budget */
    enum gd_status (*write)(struct evaluation *evaluation, uint32_t first, uint32_t count,
                            const struct gd_control *control);
};

struct evaluation {
    struct server_query query; /* must be the first member */
    union {
        struct proto_uvs nurbs;
        struct proto_limit_places limit;
    } places;
    uint32_t count;
    struct gd_detail detail;          /* detail of a failure */
    struct gd_vec3 *vectors[VECTORS]; /* for an answer as arrays */
    double (*curvatures)[2];          /* the same */
};

static const struct evaluator *evaluator_of(const struct server_query *query)
{
    return query->kind->own;
}

static enum gd_status evaluation_allocate(struct evaluation *evaluation)
{
    struct server_query *query = &evaluation->query;
    double *numbers =
        server_query_allocate(query, evaluation->count, (3 * VECTORS + 2) * sizeof *numbers);
    if (!numbers) return GD_BUDGET;
    for (int k = 0; k < VECTORS; k++)
        evaluation->vectors[k] = (struct gd_vec3 *)numbers + (size_t)evaluation->count * k;
    evaluation->curvatures = (double(*)[2])(numbers + 3 * (size_t)evaluation->count * VECTORS);
    return GD_OK;
}

/* Stores a result for an answer as arrays; NAN stands for null. */
static void evaluation_store(struct evaluation *evaluation, uint32_t i,
                             const struct gd_vec3 vectors[VECTORS], const double curvatures[2])
{
    for (int k = 0; k < VECTORS; k++) evaluation->vectors[k][i] = vectors[k];
    memcpy(evaluation->curvatures[i], curvatures, sizeof *evaluation->curvatures);
}

static bool evaluation_list_arrays(struct server_query *query)
{
    const struct evaluation *evaluation = (const struct evaluation *)query;
    uint32_t count = evaluation->count;
    for (int k = 0; k < VECTORS; k++)
        server_arrays_add_numbers(&query->arrays, vector_names[k], 3, count,
                                  (const double *)evaluation->vectors[k]);
    server_arrays_add_numbers(&query->arrays, "curvatures", 2, count,
                              (const double *)evaluation->curvatures);
    return true;
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

static enum server_query_turn evaluation_solve(struct server_query *query)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_writer *writer = &query->draft;
    enum gd_status status =
        server_query_arrays_form(query) ? evaluation_allocate(evaluation) : GD_OK;
    proto_write_object_begin(writer);
    proto_member_array(writer, "points");
    for (uint32_t i = 0; i < evaluation->count && !status; i += evaluator_of(query)->round)
        status = evaluation_write_round(evaluation, i);
    proto_write_array_end(writer);
    proto_write_object_end(writer);
    if (status) return server_smooth_fail(query, status, &evaluation->detail, "the answer");
    return server_query_end_draft(query, GD_OK, "the answer");
}

static enum server_query_turn evaluation_try_inline(struct server_query *query)
{
    if (((struct evaluation *)query)->count > evaluator_of(query)->quick) return SERVER_QUERY_AGAIN;
    return evaluation_solve(query);
}

#define EVALUATION_STEPS                                                                           \
    .name = "evaluate", .size = sizeof(struct evaluation), .try_inline = evaluation_try_inline,    \
    .solve = evaluation_solve, .list_arrays = evaluation_list_arrays

static const struct gd_vec3 no_vector = {NAN, NAN, NAN};

static void nurbs_write_jet(struct evaluation *evaluation, uint32_t i, const struct gd_jet *jet)
{
    const struct gd_curvature curvature = gd_jet_curvature(jet);
    bool is_regular = curvature.regular;
    if (evaluation->curvatures)
        evaluation_store(
            evaluation, i,
            (struct gd_vec3[]){jet->x, is_regular ? curvature.normal : no_vector, jet->u, jet->v,
                               jet->uu, jet->uv, jet->vv},
            (double[]){is_regular ? curvature.gaussian : NAN, is_regular ? curvature.mean : NAN});
    else
        proto_jet_encode(&evaluation->query.draft, jet, &evaluation->query.options);
}

static void limit_write_jet(struct evaluation *evaluation, uint32_t i,
                            const struct gd_limit_jet *jet)
{
    bool is_singular = jet->singular;
    if (evaluation->curvatures)
        evaluation_store(evaluation, i,
                         (struct gd_vec3[]){jet->position, jet->normal, jet->du, jet->dv,
                                            is_singular ? no_vector : jet->duu,
                                            is_singular ? no_vector : jet->duv,
                                            is_singular ? no_vector : jet->dvv},
                         is_singular ? (double[]){NAN, NAN} : jet->curvatures);
    else
        proto_limit_jet_encode(&evaluation->query.draft, jet, &evaluation->query.options);
}

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
        if (!status) nurbs_write_jet(evaluation, i, &jet);
    }
    return status;
}

static bool nurbs_decode(struct server_query *query, const json_t *document)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_uvs *places = &evaluation->places.nurbs;
    if (!proto_jets_decode(document, nurbs_of(query), places, query->problem)) return false;
    evaluation->count = places->count;
    return true;
}

static void nurbs_release(struct server_query *query)
{
    proto_uvs_free(&((struct evaluation *)query)->places.nurbs);
}

const struct server_query_kind server_query_nurbs_evaluate = {
    /* each place takes some microseconds */
    .own = &(const struct evaluator){.quick = 8, .round = 64, .write = nurbs_write},
    .decode = nurbs_decode,
    .release = nurbs_release,
    EVALUATION_STEPS};

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
        limit_write_jet(evaluation, first + i, &jets[i]);
    return status;
}

static bool limit_decode(struct server_query *query, const json_t *document)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    struct proto_limit_places *places = &evaluation->places.limit;
    if (!proto_limit_jets_decode(document, subdivision_of(query), places, query->problem))
        return false;
    evaluation->count = places->count;
    return true;
}

static void limit_release(struct server_query *query)
{
    proto_limit_places_free(&((struct evaluation *)query)->places.limit);
}

const struct server_query_kind server_query_subdivision_evaluate = {
    /* evaluation is slower near a vertex */
    .own = &(const struct evaluator){.quick = 4, .round = LIMIT_ROUND, .write = limit_write},
    .decode = limit_decode,
    .release = limit_release,
    EVALUATION_STEPS};

/* --- nearest: the place nearest to a point {"xyz": …} ----------------------------------------- */

struct nearest {
    struct server_query query; /* must be the first member */
    struct proto_point wanted; /* a point of space */
    union {
        struct gd_parametric_closest nurbs;
        struct gd_limit_closest limit;
    } found;
    struct gd_detail detail; /* detail of a failure */
};

struct finder {
    enum gd_status (*find)(struct nearest *nearest, const struct gd_control *control);
    double (*distance)(const struct nearest *nearest); /* returns the distance of the found point */
};

static bool nearest_decode(struct server_query *query, const json_t *document)
{
    return proto_foot_decode(document, &((struct nearest *)query)->wanted, query->problem);
}

static bool nearest_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    return proto_foot_parse(parameters, &((struct nearest *)query)->wanted, query->problem);
}

static enum server_query_turn nearest_solve(struct server_query *query)
{
    struct nearest *nearest = (struct nearest *)query;
    const struct finder *finder = query->kind->own;
    struct server_budgeted_call call = server_query_begin_call(query, NULL, NEAREST_BYTES);
    while (server_budgeted_call_next(&call)) call.status = finder->find(nearest, &call.control);
    if (call.status) return server_smooth_fail(query, call.status, &nearest->detail, "the search");
    return proto_foot_check(&nearest->wanted, finder->distance(nearest), query->problem)
               ? SERVER_QUERY_DONE
               : SERVER_QUERY_FAILED;
}

#define NEAREST_STEPS                                                                              \
    .name = "nearest", .size = sizeof(struct nearest), .decode = nearest_decode,                   \
    .parse = nearest_parse, .solve = nearest_solve

static struct gd_vec3 wanted_place(const struct nearest *nearest)
{
    const double *xyz = nearest->wanted.xyz;
    return (struct gd_vec3){xyz[0], xyz[1], xyz[2]};
}

static enum gd_status nurbs_find(struct nearest *nearest, const struct gd_control *control)
{
    return gd_parametric_nearest(nurbs_of(&nearest->query), wanted_place(nearest), control,
                                 &nearest->found.nurbs, &nearest->detail);
}

static double nurbs_distance(const struct nearest *nearest)
{
    return nearest->found.nurbs.distance;
}

static void nurbs_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_foot_encode(writer, &((const struct nearest *)query)->found.nurbs, &query->options);
}

const struct server_query_kind server_query_nurbs_nearest = {
    .own = &(const struct finder){nurbs_find, nurbs_distance},
    .encode = nurbs_encode,
    NEAREST_STEPS};

static enum gd_status limit_find(struct nearest *nearest, const struct gd_control *control)
{
    return gd_limit_nearest(subdivision_of(&nearest->query), wanted_place(nearest), control,
                            &nearest->found.limit, &nearest->detail);
}

static double limit_distance(const struct nearest *nearest)
{
    return nearest->found.limit.distance;
}

static void limit_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_limit_foot_encode(writer, &((const struct nearest *)query)->found.limit, &query->options);
}

const struct server_query_kind server_query_subdivision_nearest = {
    .own = &(const struct finder){limit_find, limit_distance},
    .encode = limit_encode,
    NEAREST_STEPS};
