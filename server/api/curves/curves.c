/* Curves: operations on a curve, cuts along a curve, and splines. All run on a worker. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/frame.h"
#include "proto/queries/curves.h"
#include "proto/values/curve.h"
#include "proto/values/spline.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/surface_resource.h"
#include "server/query/query.h"
#include "server/query/request.h"
#include "server/query/result.h"
#include "server/work/executor.h"

/* --- queries about one curve ------------------------------------------------------------------ */

/* fraction of the progress for resolving the curve; the rest is for using the curve */
#define RESOLVE_SHARE 0.5

/* Each kind of query has its own struct, which begins with this one. */
struct curve_query {
    struct server_query query; /* must be the first member */
    struct proto_located_curve curve;
    /* Uses the curve. May take over the curve's points. On success the query holds `*kept`
       bytes. */
    enum gd_status (*use)(struct curve_query *own, struct gd_curve *curve,
                          const struct gd_control *control, size_t *kept);
    struct gd_detail detail; /* detail of a failure */
};

/* Resolves the curve and uses it, in one long call. If the curve can't be resolved, the problem
 * names the curve's place in the request. */
static bool curve_solve(struct curve_query *own, size_t grant, const char *what)
{
    struct server_query *query = &own->query;
    const struct gd_landmarks *landmarks = server_query_landmarks(query);
    struct server_monitor part = server_query_monitor(query, 0, 1);
    struct server_budgeted_call call = server_query_begin_call(query, &part, grant);
    bool is_resolved = false;
    while (server_budgeted_call_next(&call)) {
        struct gd_curve curve;
        own->detail = (struct gd_detail){0};
        part = server_query_monitor(query, 0, RESOLVE_SHARE);
        call.status = proto_curve_resolve(query->surface->mesh, &own->curve, landmarks,
                                          &call.control, &curve, &own->detail);
        is_resolved = !call.status;
        if (!is_resolved) continue;
        part = server_query_monitor(query, RESOLVE_SHARE, 1 - RESOLVE_SHARE);
        call.status = own->use(own, &curve, &call.control, &call.kept);
        gd_curve_free(&curve);
    }
    if (!call.status) return true;
    if (call.status == GD_BUDGET || !own->detail.text[0])
        return server_query_refuse(query, call.status, what);
    server_metrics_count_status(query->exchange->host->metrics, call.status);
    return is_resolved
               ? proto_problem_from_status(own->query.problem, call.status, &own->detail)
               : proto_curve_fail(&own->curve, call.status, &own->detail, own->query.problem);
}

/* --- operations ------------------------------------------------------------------------------- */

struct operation_query {
    struct curve_query own; /* must be the first member */
    struct proto_curve_operation_request wanted;
    struct proto_curve_result result;
};

static bool operation_decode(struct server_query *query, const json_t *document)
{
    struct operation_query *operation = (struct operation_query *)query;
    return proto_curve_operation_request_decode(document, &operation->wanted, query->problem) &&
           proto_curve_locate(query->surface->mesh, &operation->wanted.curve, &operation->own.curve,
                              query->problem);
}

static enum gd_status curve_resample(struct operation_query *operation,
                                     const struct gd_curve *curve, const struct gd_control *control)
{
    struct proto_curve_result *result = &operation->result;
    struct gd_resampling resampling;
    enum gd_status status =
        gd_curve_resample(operation->own.query.surface->mesh,
                          &(struct gd_resampling_request){curve, operation->wanted.count}, control,
                          &resampling, &operation->own.detail);
    if (status) return status;
    result->curve = resampling.curve;
    result->points = resampling.points;
    result->point_count = resampling.count;
    return GD_OK;
}

static enum gd_status curve_shorten(struct operation_query *operation, const struct gd_curve *curve,
                                    const struct gd_control *control)
{
    const struct proto_curve_operation_request *wanted = &operation->wanted;
    struct proto_curve_result *result = &operation->result;
    struct gd_detail *detail = &operation->own.detail;
    struct gd_shortening shortening;
    if (wanted->operation == PROTO_OPERATION_CLOSED_GEODESIC && !curve->closed)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a closed geodesic comes from a closed curve; say \"closed\": true, or "
                       "\"shorten\" this one");
    enum gd_status status =
        gd_curve_shorten(operation->own.query.surface->mesh,
                         &(struct gd_shortening_request){curve, wanted->rounds, wanted->pieces},
                         control, &shortening, detail);
    if (status) return status;
    result->curve = shortening.curve;
    result->turn = shortening.turn;
    result->rounds = shortening.rounds;
    result->is_geodesic = shortening.is_geodesic;
    return GD_OK;
}

static enum gd_status curve_offset(struct operation_query *operation, const struct gd_curve *curve,
                                   const struct gd_control *control)
{
    const struct gd_mesh *mesh = operation->own.query.surface->mesh;
    struct proto_curve_result *result = &operation->result;
    struct gd_isoline isoline;
    enum gd_status status =
        gd_curve_offset(mesh, &(struct gd_offset_request){curve, operation->wanted.distance},
                        control, &isoline, &operation->own.detail);
    if (status) return status;
    result->paths = calloc(isoline.line_count + (size_t)1, sizeof *result->paths);
    result->is_closed = calloc(isoline.line_count + (size_t)1, sizeof *result->is_closed);
    if (!result->paths || !result->is_closed) status = GD_NO_MEMORY;
    for (uint32_t i = 0; i < isoline.line_count && !status; i++) {
        status = gd_isoline_flatten(mesh, &isoline.lines[i], operation->wanted.tolerance, control,
                                    &result->paths[i]);
        if (status) break;
        result->is_closed[i] = isoline.lines[i].closed;
        result->path_count++;
    }
    gd_isoline_free(&isoline);
    return status;
}

static size_t result_bytes(const struct proto_curve_result *result)
{
    size_t points = (size_t)result->curve.count + result->point_count;
    for (uint32_t i = 0; i < result->path_count; i++) points += result->paths[i].count;
    return points * sizeof(struct gd_point) +
           result->path_count * (sizeof *result->paths + sizeof *result->is_closed);
}

static enum gd_status operation_use(struct curve_query *query, struct gd_curve *curve,
                                    const struct gd_control *control, size_t *kept)
{
    struct operation_query *operation = (struct operation_query *)query;
    struct proto_curve_result *result = &operation->result;
    enum gd_status status = GD_OK;
    *result = (struct proto_curve_result){.operation = operation->wanted.operation};
    switch (result->operation) {
    case PROTO_OPERATION_RESAMPLE:
        status = curve_resample(operation, curve, control);
        break;
    case PROTO_OPERATION_SHORTEN:
    case PROTO_OPERATION_CLOSED_GEODESIC:
        status = curve_shorten(operation, curve, control);
        break;
    case PROTO_OPERATION_OFFSET:
        status = curve_offset(operation, curve, control);
        break;
    case PROTO_OPERATION_LENGTH:
        result->curve = *curve;
        *curve = (struct gd_curve){0};
        break;
    }
    if (status)
        proto_curve_result_free(result);
    else
        *kept = result_bytes(result);
    return status;
}

static enum server_query_turn operation_solve(struct server_query *query)
{
    struct curve_query *own = (struct curve_query *)query;
    own->use = operation_use;
    return curve_solve(own, server_field_build_grant(query->surface->mesh), "the curve")
               ? SERVER_QUERY_DONE
               : SERVER_QUERY_FAILED;
}

static void operation_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_curve_result_encode(writer, query->surface->mesh,
                              &((const struct operation_query *)query)->result, &query->options);
}

static void points_read(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct operation_query *operation = source;
    gd_points_positions(operation->own.query.surface->mesh, operation->result.points + first,
                        (uint32_t)count, out);
}

/* Lists the curve as a line. The line of a closed curve repeats the first point at its end. */
static bool operation_list_curve(struct operation_query *operation)
{
    struct server_query *query = &operation->own.query;
    const struct gd_curve *curve = &operation->result.curve;
    uint32_t count = curve->count + (curve->closed && curve->count > 1);
    struct gd_point *points = server_query_allocate(query, count, sizeof *points);
    if (!points) return server_query_refuse(query, GD_NO_MEMORY, "the answer");
    for (uint32_t i = 0; i < count; i++) points[i] = curve->points[i % curve->count];
    return server_query_list_line(query, points, count);
}

static bool operation_list_arrays(struct server_query *query)
{
    struct operation_query *operation = (struct operation_query *)query;
    const struct proto_curve_result *result = &operation->result;
    if (result->operation == PROTO_OPERATION_OFFSET)
        return server_query_list_lines(query, result->paths, sizeof *result->paths,
                                       result->path_count);
    if (!operation_list_curve(operation)) return false;
    if (result->operation == PROTO_OPERATION_RESAMPLE)
        server_arrays_add(&query->arrays, &(struct server_array){.name = "resampled",
                                                                 .type = SERVER_ARRAY_NUMBERS,
                                                                 .columns = 3,
                                                                 .rows = result->point_count,
                                                                 .read = points_read,
                                                                 .source = operation});
    return true;
}

static void operation_release(struct server_query *query)
{
    struct operation_query *operation = (struct operation_query *)query;
    proto_curve_result_free(&operation->result);
    proto_located_curve_free(&operation->own.curve);
    proto_curve_operation_request_free(&operation->wanted);
}

const struct server_query_kind server_query_curve = {.name = "curve",
                                                     .size = sizeof(struct operation_query),
                                                     .decode = operation_decode,
                                                     .solve = operation_solve,
                                                     .encode = operation_encode,
                                                     .list_arrays = operation_list_arrays,
                                                     .release = operation_release};

/* --- cuts ------------------------------------------------------------------------------------- */

/* A worker cuts the mesh and builds the pieces. The registry's writer thread stores them. Then a
 * worker writes the answer. */

#define CUT_BYTES_AN_EDGE 320 /* bytes of a search for the curve, or of the cut and its pieces */
#define CUT_BYTES         ((size_t)1 << 20)

struct cut_query {
    struct curve_query own; /* must be the first member */
    struct proto_cut_request wanted;
    struct gd_point inside;
    struct gd_cut cut;
    struct server_derived_meshes meshes;
    bool is_stored;
    /* the work function of the query, called when the pieces are stored */
    bool (*work)(struct server_exchange *exchange);
};

/* A figure draws pieces. It stores no meshes, and selects no faces. */
static bool cut_check_drawn(const struct proto_cut_request *wanted, struct proto_problem *problem)
{
    const char *member = wanted->names.count   ? "/names"
                         : wanted->select_only ? "/select_only"
                                               : NULL;
    return !member || proto_problem_refuse(problem, member,
                                           "a figure stores no pieces; leave out \"names\" and "
                                           "\"select_only\"");
}

static bool cut_decode(struct server_query *query, const json_t *document)
{
    struct proto_problem *problem = query->problem;
    struct cut_query *cut = (struct cut_query *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_cut_request *wanted = &cut->wanted;
    double snap;
    return proto_cut_request_decode(document, wanted, problem) &&
           (!query->is_drawn || cut_check_drawn(wanted, problem)) &&
           proto_curve_locate(mesh, &wanted->curve, &cut->own.curve, problem) &&
           (!wanted->has_inside ||
            proto_point_locate(mesh, &wanted->inside, &cut->inside, &snap, problem));
}

static enum gd_status cut_use(struct curve_query *query, struct gd_curve *curve,
                              const struct gd_control *control, size_t *kept)
{
    struct cut_query *cut = (struct cut_query *)query;
    const struct gd_cut_request request = {.curve = curve,
                                           .inside = cut->wanted.has_inside ? &cut->inside : NULL,
                                           .select_only = cut->wanted.select_only};
    enum gd_status status =
        gd_cut_along(query->query.surface->mesh, &request, control, &cut->cut, &query->detail);
    if (!status) *kept = cut->cut.bytes;
    return status;
}

static bool pieces_check(const struct cut_query *cut)
{
    uint32_t count = cut->cut.piece_count;
    if (cut->wanted.names.count && count != cut->wanted.names.count)
        return proto_problem_refuse(cut->own.query.problem, "/names",
                                    "the cut gives %u pieces, and there are %u names", count,
                                    cut->wanted.names.count);
    if (count <= SERVER_DERIVED_MESHES_MOST) return true;
    return proto_problem_exceed(
        cut->own.query.problem, NULL, SERVER_DERIVED_MESHES_MOST,
        "the cut gives %u pieces, and at most %d become meshes at a time; choose one "
        "by \"inside\", or ask with \"select_only\"",
        count, SERVER_DERIVED_MESHES_MOST);
}

/* Builds the pieces. The name of a piece is the requested name, or the parent's name with a
 * number. */
static bool pieces_build(struct cut_query *cut)
{
    const struct server_query *query = &cut->own.query;
    if (!pieces_check(cut)) return false;
    cut->meshes.exchange = query->exchange;
    for (uint32_t i = 0; i < cut->cut.piece_count; i++) {
        char name[PROTO_MESH_NAME + 1];
        int length =
            cut->wanted.names.count
                ? snprintf(name, sizeof name, "%s", cut->wanted.names.items[i].text)
                : snprintf(name, sizeof name, "%s-%u", query->surface->record->name, i + 1);
        if (length > PROTO_MESH_NAME)
            return proto_problem_refuse(
                cut->own.query.problem, "/names",
                "the mesh's name is too long to be numbered; name the pieces");
        const struct server_derived_source source = {.polygons = &cut->cut.pieces[i].polygons};
        if (!server_derived_meshes_add(&cut->meshes, name, &source, cut->own.query.problem))
            return false;
    }
    return true;
}

/* Returns a generated name that already exists, or NULL. A generated name must not replace another
 * mesh. */
static const char *pieces_find_taken(const struct cut_query *cut)
{
    struct server_registry *registry = cut->own.query.exchange->host->api->registry;
    for (uint32_t i = 0; i < cut->meshes.count && !cut->wanted.names.count; i++) {
        const struct server_record *record = cut->meshes.list[i].surface->record;
        const struct server_key key = server_record_key(record);
        struct server_listed listed;
        if (!server_registry_find(registry, &key, &listed)) continue;
        bool is_same = server_record_equal(listed.record, record);
        server_listed_release(&listed);
        if (!is_same) return record->name;
    }
    return NULL;
}

/* Runs on the registry's writer thread, so that no other mesh is stored meanwhile. */
static bool pieces_store(struct server_exchange *exchange)
{
    struct cut_query *cut = exchange->state;
    const char *taken = pieces_find_taken(cut);
    if (taken) {
        server_reply_refusal(exchange, PROTO_PROBLEM_CONFLICT,
                             "there is another mesh of the name '%s' already; give the pieces "
                             "\"names\" of their own",
                             taken);
        return true;
    }
    enum server_outcome outcome = server_derived_meshes_store(&cut->meshes);
    if (!server_request_check_stored(exchange, outcome)) return true;
    cut->is_stored = true;
    server_exchange_defer(exchange, cut->work, NULL);
    server_workers_resume(exchange->host->workers, &exchange->job);
    return false;
}

static enum server_query_turn cut_solve(struct server_query *query)
{
    struct cut_query *cut = (struct cut_query *)query;
    size_t edges = gd_mesh_summary(query->surface->mesh)->edges;
    if (cut->is_stored) return SERVER_QUERY_DONE;
    cut->own.use = cut_use;
    if (!curve_solve(&cut->own, CUT_BYTES + edges * CUT_BYTES_AN_EDGE, "the cut"))
        return SERVER_QUERY_FAILED;
    if (cut->wanted.select_only || query->is_drawn) return SERVER_QUERY_DONE;
    if (!pieces_build(cut)) return SERVER_QUERY_FAILED;
    cut->work = query->exchange->work;
    (void)server_request_write(query->exchange, pieces_store);
    return SERVER_QUERY_PARKED;
}

static void cut_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct cut_query *cut = (const struct cut_query *)query;
    uint32_t fields = query->options.fields;
    proto_cut_begin(writer, &cut->cut, fields);
    for (uint32_t i = 0; i < cut->cut.piece_count; i++) {
        const char *name =
            cut->wanted.select_only ? NULL : cut->meshes.list[i].surface->record->name;
        proto_cut_piece_encode(writer, &cut->cut.pieces[i], name, fields);
    }
    proto_cut_end(writer, &cut->cut, fields);
}

/* Lists one map, which is the concatenation of the maps of all pieces, and the index where each
 * piece begins. */
static bool cut_list_map(struct cut_query *cut, bool is_of_faces)
{
    struct server_query *query = &cut->own.query;
    uint32_t count = cut->cut.piece_count;
    uint32_t *first = server_query_allocate(query, count + (size_t)1, sizeof *first);
    for (uint32_t i = 0; first && i < count; i++) {
        const struct gd_cut_piece *piece = &cut->cut.pieces[i];
        first[i + 1] =
            first[i] + (is_of_faces ? piece->face_count : piece->polygons.position_count);
    }
    uint32_t *map = first ? server_query_allocate(query, first[count], sizeof *map) : NULL;
    if (!map) return server_query_refuse(query, GD_BUDGET, "the answer");
    for (uint32_t i = 0; i < count; i++) {
        const struct gd_cut_piece *piece = &cut->cut.pieces[i];
        memcpy(map + first[i], is_of_faces ? piece->face_map : piece->vertex_map,
               (first[i + 1] - first[i]) * sizeof *map);
    }
    server_arrays_add_indices(&query->arrays, is_of_faces ? "face_map" : "vertex_map", 0,
                              first[count], map);
    server_arrays_add_indices(&query->arrays, is_of_faces ? "face_first" : "vertex_first", 0,
                              count + UINT64_C(1), first);
    return true;
}

/* Lists the pieces as one mesh, for a figure: positions, corners, and the indices of the first
 * position and of the first corner of each piece. */
static bool cut_list_mesh(struct cut_query *cut)
{
    struct server_query *query = &cut->own.query;
    uint32_t count = cut->cut.piece_count;
    uint32_t *vertices = server_query_allocate(query, count + (size_t)1, sizeof *vertices),
             *corners = server_query_allocate(query, count + (size_t)1, sizeof *corners);
    for (uint32_t i = 0; vertices && corners && i < count; i++) {
        const struct gd_polygons *polygons = &cut->cut.pieces[i].polygons;
        vertices[i + 1] = vertices[i] + polygons->position_count;
        corners[i + 1] = corners[i] + gd_polygons_corner_count(polygons);
    }
    bool ok = vertices && corners;
    double(*positions)[3] =
        ok ? server_query_allocate(query, vertices[count], sizeof *positions) : NULL;
    uint32_t *all = ok ? server_query_allocate(query, corners[count], sizeof *all) : NULL;
    if (!positions || !all) return server_query_refuse(query, GD_BUDGET, "the pieces");
    for (uint32_t i = 0; i < count; i++) {
        const struct gd_polygons *polygons = &cut->cut.pieces[i].polygons;
        memcpy(positions + vertices[i], polygons->positions,
               polygons->position_count * sizeof *positions);
        for (uint32_t c = 0; c < corners[i + 1] - corners[i]; c++)
            all[corners[i] + c] = polygons->corners[c] + vertices[i];
    }
    struct server_arrays *arrays = &query->arrays;
    server_arrays_add_numbers(arrays, "positions", 3, vertices[count], positions[0]);
    server_arrays_add_indices(arrays, "corners", 3, corners[count] / 3, all);
    server_arrays_add_indices(arrays, "piece_vertices", 0, count + UINT64_C(1), vertices);
    server_arrays_add_indices(arrays, "piece_corners", 0, count + UINT64_C(1), corners);
    return true;
}

static bool cut_list_arrays(struct server_query *query)
{
    struct cut_query *cut = (struct cut_query *)query;
    const struct gd_cut_piece *pieces = cut->cut.pieces;
    if (query->is_drawn) return cut_list_mesh(cut);
    server_arrays_add_member(&query->arrays, "area", cut->cut.piece_count, &pieces->area,
                             sizeof *pieces);
    return cut_list_map(cut, true) && (cut->wanted.select_only || cut_list_map(cut, false));
}

static void cut_release(struct server_query *query)
{
    struct cut_query *cut = (struct cut_query *)query;
    /* the query may have moved to a stream's exchange */
    if (cut->meshes.exchange) cut->meshes.exchange = query->exchange;
    server_derived_meshes_free(&cut->meshes);
    gd_cut_free(&cut->cut);
    proto_located_curve_free(&cut->own.curve);
    proto_cut_request_free(&cut->wanted);
}

const struct server_query_kind server_query_cut = {.name = "cut",
                                                   .size = sizeof(struct cut_query),
                                                   .decode = cut_decode,
                                                   .solve = cut_solve,
                                                   .encode = cut_encode,
                                                   .list_arrays = cut_list_arrays,
                                                   .release = cut_release};

/* --- splines ---------------------------------------------------------------------------------- */

/* fraction of the progress for building the spline; the rest is for sampling */
#define SPLINE_BUILD_SHARE 0.7

struct spline_query {
    struct server_query query; /* must be the first member */
    struct proto_spline wanted;
    struct proto_located_spline located;
    struct gd_spline spline;
    struct gd_spline_line line;
    struct gd_detail detail;
    struct server_lines controls; /* for a figure: the first and the last arm of each segment */
};

static bool spline_decode(struct server_query *query, const json_t *document)
{
    struct spline_query *own = (struct spline_query *)query;
    return proto_spline_decode(document, &own->wanted, query->problem) &&
           proto_spline_locate(query->surface->mesh, &own->wanted, &own->located, query->problem);
}

static size_t spline_bytes(const struct gd_spline *spline, const struct gd_spline_line *line)
{
    size_t points = line->path.count;
    for (uint32_t i = 0; i < spline->count; i++)
        for (int k = 0; k < 3; k++) points += spline->segments[i].arms[k].count;
    return points * sizeof(struct gd_point) + line->count * sizeof *line->places +
           spline->count * (sizeof *spline->segments + sizeof *spline->knots);
}

static enum gd_status spline_make(struct spline_query *own, struct server_monitor *part,
                                  const struct gd_control *control)
{
    struct server_query *query = &own->query;
    const struct gd_mesh *mesh = query->surface->mesh;
    own->detail = (struct gd_detail){0};
    *part = server_query_monitor(query, 0, SPLINE_BUILD_SHARE);
    enum gd_status status =
        gd_spline_build(mesh, &own->located.request, control, &own->spline, &own->detail);
    if (status) return status;
    *part = server_query_monitor(query, SPLINE_BUILD_SHARE, 1 - SPLINE_BUILD_SHARE);
    own->located.sampling.spline = &own->spline;
    status = gd_spline_sample(mesh, &own->located.sampling, control, &own->line, &own->detail);
    if (status) gd_spline_free(&own->spline);
    return status;
}

static enum server_query_turn spline_solve(struct server_query *query)
{
    struct spline_query *own = (struct spline_query *)query;
    struct server_monitor part = server_query_monitor(query, 0, 1);
    struct server_budgeted_call call =
        server_query_begin_call(query, &part, server_field_build_grant(query->surface->mesh));
    own->located.request.landmarks = server_query_landmarks(query);
    /* two searches at a time */
    own->located.request.executor =
        server_executor_start(query->exchange->host->workers, 2, query->exchange->job.deadline_ns);
    while (server_budgeted_call_next(&call)) {
        call.status = spline_make(own, &part, &call.control);
        if (!call.status) call.kept = spline_bytes(&own->spline, &own->line);
    }
    server_executor_stop(own->located.request.executor);
    if (!call.status || call.status == GD_BUDGET || !own->detail.text[0])
        return server_query_end_draft(query, call.status, "the spline");
    server_metrics_count_status(query->exchange->host->metrics, call.status);
    proto_spline_fail("", call.status, &own->detail, query->problem);
    return SERVER_QUERY_FAILED;
}

static void spline_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct spline_query *own = (const struct spline_query *)query;
    proto_spline_encode(writer, query->surface->mesh, &own->spline, &own->line, own->wanted.frames,
                        &query->options);
}

#define FRAME_NUMBERS 14 /* parameter, xyz, tangent, normal, binormal, speed */

static void spline_read_frames(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct spline_query *own = source;
    double(*rows)[FRAME_NUMBERS] = out;
    for (uint64_t i = 0; i < count; i++) {
        const struct gd_spline_place *place = &own->line.places[first + i];
        const struct gd_frame frame = gd_frame_at(own->query.surface->mesh, place);
        const struct gd_vec3 vectors[] = {frame.position, frame.tangent, frame.normal,
                                          frame.binormal};
        rows[i][0] = frame.parameter;
        for (int k = 0; k < 4; k++) {
            const double xyz[3] = {vectors[k].x, vectors[k].y, vectors[k].z};
            memcpy(&rows[i][1 + 3 * k], xyz, sizeof xyz);
        }
        rows[i][FRAME_NUMBERS - 1] = place->speed;
    }
}

static bool spline_list_controls(struct spline_query *own)
{
    struct server_query *query = &own->query;
    uint32_t count = 2 * own->spline.count;
    struct gd_path *paths = server_query_allocate(query, count, sizeof *paths);
    own->controls = (struct server_lines){
        .mesh = query->surface->mesh,
        .paths = paths,
        .stride = sizeof *paths,
        .count = count,
        .first = server_query_allocate(query, count + (size_t)1, sizeof(uint32_t))};
    if (!paths || !own->controls.first) return server_query_refuse(query, GD_BUDGET, "the answer");
    for (uint32_t i = 0; i < count; i++)
        paths[i] = own->spline.segments[i / 2].arms[i % 2 ? 2 : 0]; /* borrowed */
    (void)server_lines_count(&own->controls); /* a spline has far fewer points */
    server_arrays_add_named_lines(&query->arrays, &own->controls, "controls", "controls_first");
    return true;
}

static bool spline_list_arrays(struct server_query *query)
{
    struct spline_query *own = (struct spline_query *)query;
    const struct gd_path *path = &own->line.path;
    if (!server_query_list_line(query, path->points, path->count)) return false;
    const struct gd_spline_knot *knots = own->spline.knots;
    server_arrays_add_member(&query->arrays, "parameters", own->spline.count + UINT64_C(1),
                             &knots->parameter, sizeof *knots);
    if (query->is_drawn && !spline_list_controls(own)) return false;
    if (own->wanted.frames || query->is_drawn)
        server_arrays_add(&query->arrays, &(struct server_array){.name = "frames",
                                                                 .type = SERVER_ARRAY_NUMBERS,
                                                                 .columns = FRAME_NUMBERS,
                                                                 .rows = own->line.count,
                                                                 .read = spline_read_frames,
                                                                 .source = own});
    return true;
}

#define POSES_A_CHECK 4096 /* poses computed between two checks of the deadline */

/* Computes the poses of an object at all samples. */
static enum gd_status spline_list_poses(const struct spline_query *own, struct gd_pose *out)
{
    struct server_monitor monitor = server_query_monitor(&own->query, 1, 0);
    struct gd_control control = server_exchange_control(&monitor);
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < own->line.count && !status; i++) {
        const struct gd_spline_place *place = &own->line.places[i];
        const struct gd_frame frame = gd_frame_at(own->query.surface->mesh, place);
        out[i] = (struct gd_pose){.along = place->along,
                                  .position = frame.position,
                                  .tangent = frame.tangent,
                                  .normal = frame.normal};
        if (i % POSES_A_CHECK == 0) status = gd_control_check(&control, 1);
    }
    return status;
}

/* Writes the curve. A GLB file with "frames" also has the object that moves along the curve. */
static bool spline_write(struct server_query *query, struct server_answer_file *out)
{
    const struct spline_query *own = (const struct spline_query *)query;
    size_t bytes = own->line.count * sizeof(struct gd_pose);
    if (!own->wanted.frames || query->form != SERVER_RESULT_LINE_FORM_GLB)
        return server_result_write_listed(query, out);
    if (!server_request_take(query->exchange, "the file", bytes, query->problem)) return false;
    struct gd_pose *poses = malloc(bytes);
    enum gd_status status = poses ? spline_list_poses(own, poses) : GD_NO_MEMORY;
    bool ok = status ? server_query_refuse(query, status, "the file")
                     : server_result_write_poses(query, poses, own->line.count, out);
    free(poses);
    server_budget_give(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes);
    query->exchange->held -= bytes;
    return ok;
}

static void spline_release(struct server_query *query)
{
    struct spline_query *own = (struct spline_query *)query;
    gd_spline_free(&own->spline);
    gd_spline_line_free(&own->line);
    proto_located_spline_free(&own->located);
    proto_spline_free(&own->wanted);
}

const struct server_query_kind server_query_spline = {.name = "spline",
                                                      .size = sizeof(struct spline_query),
                                                      .forms = server_result_line_forms,
                                                      .decode = spline_decode,
                                                      .solve = spline_solve,
                                                      .encode = spline_encode,
                                                      .write = spline_write,
                                                      .list_arrays = spline_list_arrays,
                                                      .release = spline_release};
