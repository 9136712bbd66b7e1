/* Answers queries for shortest paths on NURBS surfaces between two points, a point and a curve, or
 * two curves. The queries run on a worker. */
#include "server/query/result.h"
#include "server/query/handlers.h"

#include "proto/queries/geodesic_like.h"
#include "server/api/smooth/smooth.h"
#include "server/surfaces/kinds.h"

#define SEARCH_BYTES ((size_t)1 << 20)
/* bytes for the initial paths of each class of winding numbers */
#define BYTES_PER_CLASS ((size_t)128 << 10)
/* bytes for each face of the tessellation: two fields, and the traced paths */
#define BYTES_PER_FACE 1024
#define WHAT           "the search for the path"

/* The paths of an answer: path i has the rows first[i] to first[i + 1] - 1. */
struct path_arrays {
    uint32_t count, *points_first, *knots_first, *control_points_first;
    double *length, *knots, (*uv)[2], (*control_points)[2];
    struct gd_vec3 *points;
};

struct search {
    struct server_query query; /* must be the first member */
    struct proto_geodesic wanted;
    struct gd_domain_curve *ends[2], *initial; /* initial: NULL if the request has none */
    struct gd_geodesics found;
    struct gd_detail detail;
};

/* Rejects members that trimmed surfaces do not support. */
static bool search_check_trimmed(const struct proto_geodesic *wanted, struct proto_problem *problem)
{
    const bool *is_curve = wanted->form->is_curve;
    const struct gd_geodesic_members members = {wanted->has_initial, wanted->has_turns,
                                                is_curve[0] || is_curve[1]};
    const char *reason, *name = gd_geodesic_untrimmed_only(&wanted->options, &members, &reason);
    return !name || proto_problem_refuse_member(problem, "", name, "%s", reason);
}

/* Decodes the request. On a surface without a tessellation, paths can't be computed; the problem
 * gives the reason. */
static bool search_decode(struct server_query *query, const json_t *document)
{
    struct proto_problem *problem = query->problem;
    struct proto_geodesic *wanted = &((struct search *)query)->wanted;
    const struct server_nurbs *nurbs = server_nurbs_of(query->surface);
    bool has_outer;
    if (nurbs->tessellation)
        return proto_geodesic_decode(document, query->kind->own, wanted, problem) &&
               (!gd_parametric_loops(nurbs->surface, &has_outer) ||
                search_check_trimmed(wanted, problem));
    proto_problem_set(
        problem, PROTO_PROBLEM_INVALID_MESH,
        "the search for shortest paths needs a tessellation, and this surface has none: %s",
        nurbs->detail.text[0] ? nurbs->detail.text : gd_status_sentence(nurbs->refusal));
    problem->reason = gd_status_name(nurbs->refusal);
    return false;
}

static bool search_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    static const struct server_smooth_ends ends = {server_smooth_uv,
                                                   "the parameters u and v: 0.5,0.25"};
    struct proto_geodesic *wanted = &((struct search *)query)->wanted;
    if (!server_smooth_parse(query, parameters, &ends)) return false;
    for (int k = 0; k < 2; k++) proto_place_keep(wanted->ends[k].place, wanted->form->ends[k]);
    return true;
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

/* Creates on the surface a curve that the request describes. Checks the control afterwards,
 * because a long curve takes tens of milliseconds. */
static bool search_locate_curve(struct search *search, const struct proto_domain_curve *curve,
                                const struct gd_control *control, struct gd_domain_curve **out)
{
    bool is_located = proto_domain_curve_locate(server_nurbs_of(search->query.surface)->surface,
                                                curve, control, out, search->query.problem);
    enum gd_status status = gd_control_check(control, 0);
    return status ? server_query_refuse(&search->query, status, WHAT) : is_located;
}

static bool search_locate(struct search *search, struct server_monitor *monitor)
{
    const struct gd_control control = server_exchange_control(monitor);
    for (int k = 0; k < 2; k++)
        if (!search_locate_curve(search, &search->wanted.ends[k], &control, &search->ends[k]))
            return false;
    return !search->wanted.has_initial ||
           search_locate_curve(search, &search->wanted.initial, &control, &search->initial);
}

static struct proto_geodesic_answer search_answer(const struct search *search)
{
    return (struct proto_geodesic_answer){.request = &search->wanted,
                                          .ends = {search->ends[0], search->ends[1]},
                                          .found = &search->found};
}

/* Returns the bytes of the paths of all classes that the request searches. */
static size_t class_bytes(const struct gd_geodesic_options *options)
{
    size_t turns = 2 * (size_t)options->turn_limit + 1;
    return options->all_minima ? turns * turns * BYTES_PER_CLASS : BYTES_PER_CLASS;
}

static enum server_query_turn search_solve(struct server_query *query)
{
    struct search *search = (struct search *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct gd_tessellation *tessellation = server_nurbs_of(query->surface)->tessellation;
    size_t faces = gd_mesh_summary(gd_tessellation_mesh(tessellation))->faces;
    struct server_budgeted_call call = server_query_begin_call(
        query, &monitor,
        SEARCH_BYTES + faces * BYTES_PER_FACE + class_bytes(&search->wanted.options));
    if (!search_locate(search, &monitor)) return SERVER_QUERY_FAILED;
    while (server_budgeted_call_next(&call)) {
        call.status =
            gd_geodesic_solve(tessellation,
                              &(struct gd_geodesic_request){
                                  .from = search->ends[0],
                                  .to = search->ends[1],
                                  .options = &search->wanted.options,
                                  .initial = search->initial,
                                  .turns = search->wanted.has_turns ? search->wanted.turns : NULL},
                              &call.control, &search->found, &search->detail);
        if (!call.status) call.kept = found_bytes(&search->found);
    }
    if (call.status == GD_INVALID_ARGUMENT) {
        proto_problem_from_status(query->problem, call.status, &search->detail);
        if (search->wanted.has_initial || search->wanted.has_turns)
            proto_problem_at(query->problem, search->wanted.has_initial ? "/initial" : "/turns");
        return SERVER_QUERY_FAILED;
    }
    if (call.status) {
        server_query_fail(query, call.status, WHAT);
        if (call.status == GD_INTERNAL)
            proto_problem_set(query->problem, PROTO_PROBLEM_INTERNAL,
                              "%s; request a larger tolerance, or report the request",
                              search->detail.text[0] ? search->detail.text
                                                     : gd_status_sentence(call.status));
        return SERVER_QUERY_FAILED;
    }
    const struct proto_geodesic_answer answer = search_answer(search);
    enum gd_status status = proto_geodesic_encode(&query->draft, &answer, &query->options);
    return server_query_end_draft(query, status, "the answer");
}

/* --- arrays ----------------------------------------------------------------------------------- */

/* Returns true if the answer lists path i. It lists the shortest path, and with all_minima the
 * other minima. */
static bool search_lists(const struct search *search, uint32_t i)
{
    return i == 0 || (search->wanted.options.all_minima && search->found.items[i].is_minimum);
}

/* Allocates the arrays and fills in the counts of rows before each path. Returns NULL if out of
 * memory. */
static struct path_arrays *path_arrays_reserve(struct search *search)
{
    struct server_query *query = &search->query;
    struct path_arrays *arrays = server_query_allocate(query, 1, sizeof *arrays);
    size_t most = search->found.count + (size_t)1;
    uint32_t *first = arrays ? server_query_allocate(query, 3 * most, sizeof *first) : NULL;
    if (!first) return NULL;
    arrays->points_first = first;
    arrays->knots_first = first + most;
    arrays->control_points_first = first + 2 * most;
    for (uint32_t i = 0; i < search->found.count; i++) {
        const struct gd_geodesic *path = &search->found.items[i];
        uint32_t k = arrays->count;
        if (!search_lists(search, i)) continue;
        arrays->points_first[k + 1] =
            arrays->points_first[k] + proto_geodesic_sample_count(&search->wanted, path);
        arrays->knots_first[k + 1] = arrays->knots_first[k] + proto_geodesic_knots(path, NULL);
        arrays->control_points_first[k + 1] =
            arrays->control_points_first[k] + proto_geodesic_control_points(path, NULL);
        arrays->count++;
    }
    uint32_t count = arrays->count, points = arrays->points_first[count],
             knots = arrays->knots_first[count], controls = arrays->control_points_first[count];
    double *room = server_query_allocate(
        query, count + 5 * (size_t)points + knots + 2 * (size_t)controls, sizeof *room);
    if (!room) return NULL;
    arrays->points = (struct gd_vec3 *)room;
    arrays->uv = (double(*)[2])(room + 3 * (size_t)points);
    arrays->control_points = arrays->uv + points;
    arrays->knots = room + 5 * (size_t)points + 2 * (size_t)controls;
    arrays->length = arrays->knots + knots;
    return arrays;
}

static enum gd_status path_arrays_fill(struct search *search, const struct path_arrays *arrays)
{
    const struct proto_geodesic_answer answer = search_answer(search);
    enum gd_status status = GD_OK;
    uint32_t k = 0;
    for (uint32_t i = 0; i < search->found.count && !status; i++) {
        const struct gd_geodesic *path = &search->found.items[i];
        if (!search_lists(search, i)) continue;
        uint32_t first = arrays->points_first[k];
        arrays->length[k] = path->length;
        proto_geodesic_knots(path, arrays->knots + arrays->knots_first[k]);
        proto_geodesic_control_points(path,
                                      arrays->control_points + arrays->control_points_first[k]);
        status = proto_geodesic_sample(&answer, path, arrays->uv + first, arrays->points + first);
        k++;
    }
    return status;
}

static bool search_list_arrays(struct server_query *query)
{
    struct search *search = (struct search *)query;
    struct server_arrays *out = &query->arrays;
    const struct path_arrays *arrays = path_arrays_reserve(search);
    enum gd_status status = arrays ? path_arrays_fill(search, arrays) : GD_BUDGET;
    if (status) return server_query_refuse(query, status, "the answer");
    uint32_t count = arrays->count, points = arrays->points_first[count];
    server_arrays_add_numbers(out, "points", 3, points, (const double *)arrays->points);
    server_arrays_add_indices(out, "first", 0, count + UINT64_C(1), arrays->points_first);
    server_arrays_add_numbers(out, "uv", 2, points, (const double *)arrays->uv);
    server_arrays_add_numbers(out, "length", 0, count, arrays->length);
    server_arrays_add_numbers(out, "knots", 0, arrays->knots_first[count], arrays->knots);
    server_arrays_add_indices(out, "knots_first", 0, count + UINT64_C(1), arrays->knots_first);
    server_arrays_add_numbers(out, "control_points", 2, arrays->control_points_first[count],
                              (const double *)arrays->control_points);
    server_arrays_add_indices(out, "control_points_first", 0, count + UINT64_C(1),
                              arrays->control_points_first);
    return true;
}

static void search_release(struct server_query *query)
{
    struct search *search = (struct search *)query;
    gd_geodesics_free(&search->found);
    for (int k = 0; k < 2; k++) gd_domain_curve_release(search->ends[k]);
    gd_domain_curve_release(search->initial);
    proto_geodesic_free(&search->wanted);
}

/* --- the three operations --------------------------------------------------------------------- */

#define SEARCH_STEPS                                                                               \
    .size = sizeof(struct search), .forms = server_result_smooth_line_forms,                       \
    .write = server_result_write_listed, .decode = search_decode, .parse = search_parse,           \
    .solve = search_solve, .list_arrays = search_list_arrays, .release = search_release

const struct server_query_kind server_query_nurbs_geodesic = {
    .name = "geodesic", .own = &proto_geodesic_between_points, SEARCH_STEPS};

const struct server_query_kind server_query_nurbs_point_curve_distance = {
    .name = "point-curve-distance", .own = &proto_geodesic_to_curve, SEARCH_STEPS};

const struct server_query_kind server_query_nurbs_curve_distance = {
    .name = "curve-distance", .own = &proto_geodesic_between_curves, SEARCH_STEPS};
