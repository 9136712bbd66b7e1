/* Bulk: the distances of many pairs of points, and the nearest points of many points. Requests and
 * answers have the form of JSON or of arrays (arrays.h).
 *
 * DESIGN. All idle workers locate the points of a request. Pairs are sorted by the end (from or to)
 * with fewer different points. The pairs with the same point at this end are a group. If the point
 * has a cached field, its group is evaluated in pieces, in parallel. Small groups without a cached
 * field are searched pair by pair. For a large group without a cached field, a propagation computes
 * the distances and keeps no field. Groups without a cached field run in parallel, too. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/writer.h"
#include "proto/values/bulk_points.h"
#include "proto/values/point.h"
#include "server/fields/cache.h"
#include "server/query/query.h"
#include "server/work/budgeted_call.h"

#define MOST  4000000 /* largest number of pairs or points in a request */
#define PIECE 16384   /* number of points that one task locates or evaluates */
/* number of pairs whose searches take half as long as a field */
#define FEW    (SERVER_CACHE_SEARCHES / 2)
#define COLUMN 16 /* bytes that an evaluation needs for each point */
#define PLACE  PROTO_KEPT_PLACE

/* --- a list of points ------------------------------------------------------------------------- */

struct point_list {
    struct gd_point *points;
    /* distance by which each point was moved onto the surface; NAN means that it was not moved */
    double *snaps;
    uint32_t count;
};

/* Allocates the arrays of a list. Does nothing if they already have this size, as after
 * list_read_text. */
static bool list_reserve(struct server_query *query, uint64_t count, const char *place,
                         struct point_list *list)
{
    if (list->points && list->snaps && list->count == count) return true;
    if (count == 0) return proto_problem_refuse(query->problem, place, "name at least one point");
    if (count > MOST)
        return proto_problem_exceed(query->problem, place, MOST,
                                    "at most %d points are taken here; send them in parts", MOST);
    list->count = (uint32_t)count;
    list->points = server_query_allocate(query, count, sizeof *list->points);
    list->snaps = server_query_allocate(query, count, sizeof *list->snaps);
    return (list->points && list->snaps) || server_query_refuse(query, GD_BUDGET, "the request");
}

struct point_text {
    const json_t *value;
    char place[PLACE];
};

static bool list_decode_point(const struct server_query *query, const struct point_text *text,
                              struct point_list *list, uint32_t i)
{
    struct proto_point point;
    return proto_point_decode(text->value, text->place, &point, query->problem) &&
           proto_point_locate(query->surface->mesh, &point, &list->points[i], &list->snaps[i],
                              query->problem);
}

static bool list_decode(struct server_query *query, const json_t *document, const char *pointer,
                        struct point_list *list)
{
    const json_t *value = proto_decode_member(document, "", pointer + 1, query->problem);
    if (!value) return false;
    if (!json_is_array(value))
        return proto_problem_refuse(query->problem, pointer, "expected an array of points here");
    if (!list_reserve(query, json_array_size(value), pointer, list)) return false;
    for (uint32_t i = 0; i < list->count; i++) {
        struct point_text text = {.value = json_array_get(value, i)};
        snprintf(text.place, sizeof text.place, "%s/%u", pointer, i);
        if (!list_decode_point(query, &text, list, i)) return false;
    }
    return true;
}

/* Runs a task for each piece of `count` items. */
static enum gd_status pieces_run(const struct server_query *query, uint32_t count,
                                 enum gd_status (*run)(void *user, uint32_t piece), void *user)
{
    struct server_tasks tasks = {.run = run, .user = user};
    return server_query_run_tasks(query, &tasks, count / PIECE + (count % PIECE > 0));
}

/* --- a list as text --------------------------------------------------------------------------- */

/* The text of a list in pieces, which are read in parallel. */
struct list_text {
    const struct server_query *query;
    const struct point_list *list;
    struct proto_bulk_text pieces[MOST / PIECE + 1];
};

static enum gd_status text_locate_piece(void *user, uint32_t piece)
{
    struct list_text *text = user;
    const struct point_list *list = text->list;
    struct server_monitor monitor = server_query_monitor(text->query, 0, 1);
    const struct gd_control control = server_exchange_control(&monitor);
    struct proto_bulk_text points = text->pieces[piece];
    uint32_t i = piece * PIECE, end = list->count - i < PIECE ? list->count : i + PIECE;
    bool ok = !gd_control_check(&control, 0);
    for (; i < end && ok; i++) {
        struct proto_problem problem;
        struct proto_point point;
        ok = proto_bulk_point(&points, &point) &&
             proto_point_locate(text->query->surface->mesh, &point, &list->points[i],
                                &list->snaps[i], &problem);
    }
    return ok && points.at == points.end ? GD_OK : GD_SYNTAX;
}

/* Reads a list whose opening bracket was already read. Returns false if the text is not plain, or a
 * point is wrong. */
static bool list_read_text(struct server_query *query, struct proto_bulk_text *all,
                           struct point_list *list)
{
    struct list_text text = {.query = query, .list = list};
    uint32_t pieces = 0, count = 0, some = PIECE;
    bool is_last = false;
    while (!is_last && some == PIECE && count < MOST) {
        some = proto_bulk_split(all, PIECE, &text.pieces[pieces++], &is_last);
        count += some;
    }
    if (!is_last || count > MOST || !list_reserve(query, count, "", list)) return false;
    return !pieces_run(query, count, text_locate_piece, &text);
}

/* --- a list as arrays ------------------------------------------------------------------------- */

/* The arrays of a list "x". Either `x` contains vertices or coordinates, or `x_face` contains faces
 * and `x_barycentric` the barycentric coordinates in these faces. */
struct list_arrays {
    const struct server_array *points, *faces, *places;
    const struct gd_mesh *mesh;
    const struct point_list *list;
    atomic_uint failed_at; /* index of a point that can't be located */
};

static enum gd_status array_locate(const struct list_arrays *arrays, uint32_t i,
                                   struct gd_point *out, double *snap, struct gd_detail *detail)
{
    const struct server_array *points = arrays->points, *places = arrays->places;
    *snap = NAN;
    if (!points) {
        const double place[3] = {server_array_number(places, 3 * (uint64_t)i),
                                 server_array_number(places, 3 * (uint64_t)i + 1),
                                 server_array_number(places, 3 * (uint64_t)i + 2)};
        const struct gd_face face = {server_array_index(arrays->faces, i)};
        return gd_point_in_face(arrays->mesh, face, place, out, detail);
    }
    if (points->type == SERVER_ARRAY_INDICES) {
        const struct gd_vertex vertex = {server_array_index(points, i)};
        return gd_point_at_vertex(arrays->mesh, vertex, out, detail);
    }
    const struct gd_vec3 xyz = {server_array_number(points, 3 * (uint64_t)i),
                                server_array_number(points, 3 * (uint64_t)i + 1),
                                server_array_number(points, 3 * (uint64_t)i + 2)};
    enum gd_status status = gd_locate_nearest(arrays->mesh, xyz, -1, out, detail);
    if (!status) *snap = gd_locate_distance(arrays->mesh, xyz, out);
    return status;
}

static enum gd_status arrays_locate_piece(void *user, uint32_t piece)
{
    struct list_arrays *arrays = user;
    const struct point_list *list = arrays->list;
    uint32_t i = piece * PIECE, end = list->count - i < PIECE ? list->count : i + PIECE;
    enum gd_status status = GD_OK;
    for (; i < end && !status; i++) {
        status = array_locate(arrays, i, &list->points[i], &list->snaps[i], NULL);
        if (status) atomic_store(&arrays->failed_at, i);
    }
    return status;
}

static bool arrays_check(const struct list_arrays *arrays, const char *name,
                         struct proto_problem *problem)
{
    const struct server_array *points = arrays->points, *faces = arrays->faces,
                              *places = arrays->places;
    bool is_index = points && points->type == SERVER_ARRAY_INDICES,
         ok = points ? !faces && !places && points->columns == (is_index ? 0 : 3)
                     : faces && places && faces->type == SERVER_ARRAY_INDICES && !faces->columns &&
                           places->type != SERVER_ARRAY_INDICES && places->columns == 3 &&
                           faces->rows == places->rows;
    return ok ||
           proto_problem_refuse(problem, name,
                                "expected uint32 vertices, or numbers of 3 columns; or faces with "
                                "as many barycentric coordinates of 3 columns");
}

static bool list_read(struct server_query *query, const struct server_arrays *all,
                      const char *pointer, struct point_list *list)
{
    struct proto_problem *problem = query->problem;
    char faces[SERVER_ARRAYS_NAME], places[SERVER_ARRAYS_NAME], place[PLACE];
    struct gd_detail detail = {0};
    snprintf(faces, sizeof faces, "%s_face", pointer + 1);
    snprintf(places, sizeof places, "%s_barycentric", pointer + 1);
    struct list_arrays arrays = {.points = server_arrays_find(all, pointer + 1),
                                 .faces = server_arrays_find(all, faces),
                                 .places = server_arrays_find(all, places),
                                 .mesh = query->surface->mesh,
                                 .list = list};
    if (!arrays_check(&arrays, pointer, problem)) return false;
    uint64_t count = arrays.points ? arrays.points->rows : arrays.faces->rows;
    if (!list_reserve(query, count, pointer, list)) return false;
    if (!pieces_run(query, list->count, arrays_locate_piece, &arrays)) return true;
    uint32_t at = atomic_load(&arrays.failed_at);
    enum gd_status status = array_locate(&arrays, at, &list->points[at], &list->snaps[at], &detail);
    proto_problem_from_status(problem, status, &detail);
    snprintf(place, sizeof place, "%s/%u", pointer, at);
    return proto_problem_at(problem, place);
}

/* --- pairs: the question ---------------------------------------------------------------------- */

struct pair_order { /* a pair in a group */
    uint64_t element;
    uint32_t pair;
};

struct pairs_query {
    struct server_query query; /* must be the first member */
    struct point_list from, to;
    uint32_t count;
    double *distances; /* INFINITY means no path */

    const struct point_list *row; /* the end by which pairs are sorted */
    const struct point_list *column;
    struct pair_order *order;
    /* index in `order` where each group begins; one more entry for the end of the last group */
    uint32_t *group;
    uint32_t *pending; /* groups without a cached field */
    uint32_t group_count, pending_count;
    struct gd_point *columns; /* the other ends of the pairs, sorted as `order` */
    double *found;            /* the distances of the pairs, sorted as `order` */
    const struct gd_field *field;
};

static const char *const pairs_arrays[] = {
    "from", "from_face", "from_barycentric", "to", "to_face", "to_barycentric", NULL};

static bool pairs_settle(struct pairs_query *own)
{
    uint32_t from = own->from.count, to = own->to.count;
    own->count = from > to ? from : to;
    return from == to || from == 1 || to == 1 ||
           proto_problem_refuse(own->query.problem, "/to",
                                "there are %u points in from and %u in to; send equally many, "
                                "or one point in from or to",
                                from, to);
}

static bool pairs_decode_list(struct pairs_query *own, const json_t *value)
{
    struct server_query *query = &own->query;
    struct point_list *ends[] = {&own->from, &own->to};
    if (!json_is_array(value))
        return proto_problem_refuse(own->query.problem, "/pairs",
                                    "expected an array of pairs here");
    for (int end = 0; end < 2; end++)
        if (!list_reserve(query, json_array_size(value), "/pairs", ends[end])) return false;
    for (uint32_t i = 0; i < own->from.count; i++) {
        const json_t *pair = json_array_get(value, i);
        struct point_text text;
        snprintf(text.place, sizeof text.place, "/pairs/%u", i);
        if (json_array_size(pair) != 2)
            return proto_problem_refuse(own->query.problem, text.place,
                                        "expected an array of two points");
        for (uint32_t end = 0; end < 2; end++) {
            text.value = json_array_get(pair, end);
            snprintf(text.place, sizeof text.place, "/pairs/%u/%u", i, end);
            if (!list_decode_point(query, &text, ends[end], i)) return false;
        }
    }
    own->count = own->from.count;
    return true;
}

static bool pairs_decode(struct server_query *query, const json_t *document)
{
    struct pairs_query *own = (struct pairs_query *)query;
    if (!proto_decode_object(document, "", proto_pairs_request_members, query->problem))
        return false;
    const json_t *pairs = json_object_get(document, "pairs");
    if (!pairs)
        return list_decode(query, document, "/from", &own->from) &&
               list_decode(query, document, "/to", &own->to) && pairs_settle(own);
    if (json_object_size(document) > 1)
        return proto_problem_refuse(query->problem, "/pairs", "send either pairs, or from and to");
    return pairs_decode_list(own, pairs);
}

static bool pairs_read(struct server_query *query, const struct server_arrays *arrays)
{
    struct pairs_query *own = (struct pairs_query *)query;
    return list_read(query, arrays, "/from", &own->from) &&
           list_read(query, arrays, "/to", &own->to) && pairs_settle(own);
}

/* Reads a request of plain lists (proto/values/bulk_points.h). */
static bool pairs_read_text(struct server_query *query, const char *bytes, size_t size)
{
    static const char *const names[] = {"from", "to", NULL};
    struct pairs_query *own = (struct pairs_query *)query;
    struct proto_bulk_text text = {bytes, bytes + size};
    int first = proto_bulk_open(&text, names, true);
    if (first < 0 || !list_read_text(query, &text, first ? &own->to : &own->from)) return false;
    return proto_bulk_open(&text, names, false) == 1 - first &&
           list_read_text(query, &text, first ? &own->from : &own->to) && proto_bulk_end(&text) &&
           pairs_settle(own);
}

/* --- pairs: groups ---------------------------------------------------------------------------- */

static const struct gd_point *end_of(const struct point_list *list, uint32_t pair)
{
    return &list->points[list->count == 1 ? 0 : pair];
}

static int compare_places(const struct gd_point *x, const struct gd_point *y)
{
    return memcmp(x->weight, y->weight, sizeof x->weight);
}

static int order_compare(const void *a, const void *b, void *points)
{
    const struct pair_order *x = a, *y = b;
    const struct gd_point *list = points;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    int places = compare_places(&list[x->pair], &list[y->pair]);
    if (places) return places;
    return (x->pair > y->pair) - (x->pair < y->pair);
}

/* Sorts the pairs by one of their ends. Returns the number of different points at this end. */
static uint32_t pairs_sort(struct pairs_query *own, const struct point_list *row)
{
    const struct gd_point *points = row->points;
    uint32_t count = own->count, groups = 0;
    own->row = row;
    own->column = row == &own->from ? &own->to : &own->from;
    for (uint32_t i = 0; i < count; i++)
        own->order[i] = (struct pair_order){
            row->count == 1 ? 0 : (uint64_t)points[i].kind << 32 | points[i].element, i};
    if (row->count > 1)
        qsort_r(own->order, count, sizeof *own->order, order_compare, (void *)points);
    for (uint32_t i = 0; i < count; i++) {
        const struct pair_order *at = &own->order[i];
        bool is_same =
            i && (row->count == 1 || (at->element == at[-1].element &&
                                      !compare_places(&points[at->pair], &points[at[-1].pair])));
        if (!is_same) own->group[groups++] = i;
    }
    own->group[groups] = count;
    return own->group_count = groups;
}

static enum gd_status pairs_reserve(struct pairs_query *own)
{
    struct server_query *query = &own->query;
    own->distances = server_query_allocate(query, own->count, sizeof *own->distances);
    own->found = server_query_allocate(query, own->count, sizeof *own->found);
    own->order = server_query_allocate(query, own->count, sizeof *own->order);
    own->columns = server_query_allocate(query, own->count, sizeof *own->columns);
    own->group = server_query_allocate(query, own->count + (size_t)1, sizeof *own->group);
    own->pending = server_query_allocate(query, own->count, sizeof *own->pending);
    return own->distances && own->found && own->order && own->columns && own->group && own->pending
               ? GD_OK
               : GD_BUDGET;
}

static const struct gd_point *group_point(const struct pairs_query *own, uint32_t group)
{
    return end_of(own->row, own->order[own->group[group]].pair);
}

/* --- pairs: groups with a cached field -------------------------------------------------------- */

struct group_run {
    struct pairs_query *own;
    uint32_t begin, end; /* indices in `order` */
};

static enum gd_status group_evaluate_piece(void *user, uint32_t piece)
{
    const struct group_run *run = user;
    struct pairs_query *own = run->own;
    struct server_monitor monitor = server_query_monitor(&own->query, 0, 1);
    const struct gd_control control = server_exchange_control(&monitor);
    uint32_t begin = run->begin + piece * PIECE,
             count = run->end - begin < PIECE ? run->end - begin : PIECE;
    return gd_field_distances(own->field, own->columns + begin, count, &control,
                              own->found + begin);
}

/* Answers the group from a cached field. If there is none, the group becomes pending. */
static enum gd_status group_find(struct pairs_query *own, uint32_t group)
{
    struct group_run run = {own, own->group[group], own->group[group + 1]};
    const struct server_cached *cached =
        server_cache_find(own->query.surface->fields, group_point(own, group));
    if (!cached) {
        own->pending[own->pending_count++] = group;
        return GD_OK;
    }
    own->field = cached->field;
    enum gd_status status =
        pieces_run(&own->query, run.end - run.begin, group_evaluate_piece, &run);
    server_cache_unpin(cached);
    return status;
}

/* --- pairs: the other groups ------------------------------------------------------------------ */

/* Answers a group by a propagation that keeps no field. */
static enum gd_status group_propagate(struct pairs_query *own, uint32_t group,
                                      const struct gd_control *control)
{
    uint32_t begin = own->group[group], count = own->group[group + 1] - begin;
    const struct gd_seed seed = {.point = *group_point(own, group)};
    const struct gd_field_request request = {
        .seeds = &seed, .seed_count = 1, .points = own->columns + begin, .point_count = count};
    return gd_field_distances_only(own->query.surface->mesh, &request, control, own->found + begin,
                                   NULL);
}

static enum gd_status group_search(struct pairs_query *own, uint32_t group,
                                   struct server_monitor *monitor)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = own->group[group]; i < own->group[group + 1] && !status; i++) {
        const struct server_pair pair = {group_point(own, group), &own->columns[i],
                                         GD_PAIR_DISTANCE};
        struct gd_pair_answer answer;
        status = server_pair_solve(monitor, own->query.surface, &pair, &answer);
        if (!status) own->found[i] = answer.distance;
    }
    return status;
}

static enum gd_status group_run(void *user, uint32_t number)
{
    struct pairs_query *own = user;
    uint32_t group = own->pending[number], count = own->group[group + 1] - own->group[group];
    double share = 1.0 / own->pending_count;
    struct server_monitor monitor = server_query_monitor(&own->query, number * share, share);
    if (count < FEW) return group_search(own, group, &monitor);
    struct server_budgeted_call call = {.workspaces = own->query.exchange->host->workspaces,
                                        .control = server_exchange_control(&monitor),
                                        .grant =
                                            server_distances_only_grant(own->query.surface->mesh),
                                        .aside = (size_t)count * COLUMN};
    while (server_budgeted_call_next(&call))
        call.status = group_propagate(own, group, &call.control);
    return call.status;
}

/* --- pairs: the answer ------------------------------------------------------------------------ */

static enum gd_status pairs_work(struct pairs_query *own)
{
    uint32_t by_from = pairs_sort(own, &own->from);
    if (by_from > 1 && pairs_sort(own, &own->to) > by_from) pairs_sort(own, &own->from);
    for (uint32_t i = 0; i < own->count; i++)
        own->columns[i] = *end_of(own->column, own->order[i].pair);
    struct server_tasks pending = {.run = group_run, .user = own};
    enum gd_status status = GD_OK;
    for (uint32_t group = 0; group < own->group_count && !status; group++)
        status = group_find(own, group);
    if (!status) status = server_query_run_tasks(&own->query, &pending, own->pending_count);
    for (uint32_t i = 0; i < own->count; i++) own->distances[own->order[i].pair] = own->found[i];
    return status;
}

static enum server_query_turn pairs_solve(struct server_query *query)
{
    struct pairs_query *own = (struct pairs_query *)query;
    enum gd_status status = pairs_reserve(own);
    if (!status) status = pairs_work(own);
    return server_query_end_draft(query, status, "the pairs");
}

static void pairs_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct pairs_query *own = (const struct pairs_query *)query;
    proto_write_object_begin(writer);
    if (query->options.fields & PROTO_PAIRS_FIELD_DISTANCES) {
        proto_write_key(writer, "distances");
        proto_write_numbers(writer, own->distances, own->count);
    }
    proto_write_object_end(writer);
}

static bool pairs_list_arrays(struct server_query *query)
{
    const struct pairs_query *own = (const struct pairs_query *)query;
    server_arrays_add_numbers(&query->arrays, "distances", 0, own->count, own->distances);
    return true;
}

const struct server_query_kind server_query_pairs = {.name = "pairs",
                                                     .size = sizeof(struct pairs_query),
                                                     .decode = pairs_decode,
                                                     .read_text = pairs_read_text,
                                                     .array_names = pairs_arrays,
                                                     .read_arrays = pairs_read,
                                                     .solve = pairs_solve,
                                                     .encode = pairs_encode,
                                                     .list_arrays = pairs_list_arrays};

/* --- nearest points --------------------------------------------------------------------------- */

struct nearest_points_query {
    struct server_query query; /* must be the first member */
    struct point_list list;
};

static const char *const nearest_arrays[] = {"points", "points_face", "points_barycentric", NULL};

static bool nearest_points_decode(struct server_query *query, const json_t *document)
{
    struct nearest_points_query *own = (struct nearest_points_query *)query;
    return proto_decode_object(document, "", proto_nearest_points_request_members,
                               query->problem) &&
           list_decode(query, document, "/points", &own->list);
}

static bool nearest_points_read_text(struct server_query *query, const char *bytes, size_t size)
{
    static const char *const names[] = {"points", NULL};
    struct proto_bulk_text text = {bytes, bytes + size};
    return proto_bulk_open(&text, names, true) == 0 &&
           list_read_text(query, &text, &((struct nearest_points_query *)query)->list) &&
           proto_bulk_end(&text);
}

static bool nearest_points_read(struct server_query *query, const struct server_arrays *arrays)
{
    struct nearest_points_query *own = (struct nearest_points_query *)query;
    return list_read(query, arrays, "/points", &own->list);
}

static void nearest_read_faces(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct nearest_points_query *own = source;
    for (uint64_t i = 0; i < count; i++) {
        struct gd_point_description description;
        gd_point_describe(own->query.surface->mesh, &own->list.points[first + i], &description);
        ((uint32_t *)out)[i] = description.face.index;
    }
}

static void nearest_read_places(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct nearest_points_query *own = source;
    double(*at)[3] = out;
    for (uint64_t i = 0; i < count; i++) {
        struct gd_point_description description;
        gd_point_describe(own->query.surface->mesh, &own->list.points[first + i], &description);
        memcpy(at[i], description.barycentric, sizeof at[i]);
    }
}

static void nearest_read_xyz(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct nearest_points_query *own = source;
    gd_points_positions(own->query.surface->mesh, own->list.points + first, (uint32_t)count, out);
}

static void nearest_points_list(const struct nearest_points_query *own,
                                struct server_arrays *arrays)
{
    const struct server_array all[] = {
        {"faces", SERVER_ARRAY_INDICES, 0, own->list.count, nearest_read_faces, own, 0},
        {"barycentric", SERVER_ARRAY_NUMBERS, 3, own->list.count, nearest_read_places, own, 0},
        {"xyz", SERVER_ARRAY_NUMBERS, 3, own->list.count, nearest_read_xyz, own, 0},
        {"snap_distances", SERVER_ARRAY_NUMBERS, 0, own->list.count, NULL, own->list.snaps, 0}};
    for (uint32_t i = 0; i < sizeof all / sizeof *all; i++)
        if (own->query.options.fields >> i & 1) server_arrays_add(arrays, &all[i]);
}

static void nearest_points_encode(const struct server_query *query, struct proto_writer *writer)
{
    struct server_arrays arrays = {0};
    nearest_points_list((const struct nearest_points_query *)query, &arrays);
    proto_write_object_begin(writer);
    for (uint32_t i = 0; i < arrays.count; i++) {
        proto_write_key(writer, arrays.list[i].name);
        server_array_encode(&arrays.list[i], writer);
    }
    proto_write_object_end(writer);
}

static bool nearest_points_list_arrays(struct server_query *query)
{
    nearest_points_list((const struct nearest_points_query *)query, &query->arrays);
    return true;
}

/* Locating the points is all the work; the solve step only answers. */
const struct server_query_kind server_query_nearest_points = {
    .name = "nearest-points",
    .size = sizeof(struct nearest_points_query),
    .decode = nearest_points_decode,
    .read_text = nearest_points_read_text,
    .array_names = nearest_arrays,
    .read_arrays = nearest_points_read,
    .encode = nearest_points_encode,
    .list_arrays = nearest_points_list_arrays};
