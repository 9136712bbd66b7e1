/* Cut: a mesh along a curve. A worker cuts it and builds the pieces, the registry's writer stores
 * them, a worker writes the answer. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/cut.h"
#include "server/http/reply.h"
#include "server/query/api.h"
#include "server/query/curve_query.h"
#include "server/query/derived_mesh.h"
#include "server/query/request.h"

#define BYTES_AN_EDGE 320 /* a search for the curve, or the cut and its pieces */
#define BYTES_A_CUT   ((size_t)1 << 20)

struct cut_query {
    struct server_curve_query own; /* first */
    bool has_inside, select_only;
    struct gd_point inside;
    char (*names)[PROTO_MESH_NAME + 1]; /* NULL: none were given */
    uint32_t name_count;

    struct gd_cut cut;
    struct server_derived_meshes meshes;
    bool is_stored;
    bool (*work)(struct server_exchange *exchange); /* of the query, for when they are stored */
};

static bool cut_decode(struct server_query *query, const json_t *document,
                       struct proto_problem *problem)
{
    struct cut_query *cut = (struct cut_query *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_cut wanted;
    double snap;
    if (!proto_cut_decode(document, &wanted, problem)) return false;
    bool ok = proto_curve_locate(mesh, &wanted.curve, &cut->own.curve, problem) &&
              (!wanted.has_inside ||
               proto_point_locate(mesh, &wanted.inside, &cut->inside, &snap, problem));
    cut->has_inside = wanted.has_inside;
    cut->select_only = wanted.select_only;
    cut->names = wanted.names;
    cut->name_count = wanted.name_count;
    wanted.names = NULL;
    proto_cut_free(&wanted);
    return ok;
}

static enum gd_status cut_make(struct server_curve_query *query, struct gd_curve *curve,
                               const struct gd_control *control, size_t *kept)
{
    struct cut_query *cut = (struct cut_query *)query;
    const struct gd_cut_request request = {.curve = curve,
                                           .inside = cut->has_inside ? &cut->inside : NULL,
                                           .select_only = cut->select_only};
    enum gd_status status =
        gd_cut_along(query->query.surface->mesh, &request, control, &cut->cut, &query->detail);
    if (!status) *kept = cut->cut.bytes;
    return status;
}

/* --- the meshes ------------------------------------------------------------------------------- */

static bool pieces_check(const struct cut_query *cut, struct proto_problem *problem)
{
    uint32_t count = cut->cut.piece_count;
    if (cut->names && count != cut->name_count)
        return proto_problem_refuse(problem, "/names",
                                    "the cut gives %u pieces, and there are %u names", count,
                                    cut->name_count);
    if (count <= SERVER_DERIVED_MESHES_MOST) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "the cut gives %u pieces, and at most %d become meshes at a time; choose one "
                      "by \"inside\", or ask with \"select_only\"",
                      count, SERVER_DERIVED_MESHES_MOST);
    return proto_problem_limit(problem, SERVER_DERIVED_MESHES_MOST);
}

/* A piece has the name that was given, or the parent's with a number. */
static bool pieces_build(struct cut_query *cut, struct proto_problem *problem)
{
    const struct server_query *query = &cut->own.query;
    if (!pieces_check(cut, problem)) return false;
    server_derived_meshes_begin(&cut->meshes, query->exchange);
    for (uint32_t i = 0; i < cut->cut.piece_count; i++) {
        char name[PROTO_MESH_NAME + 1];
        int length =
            cut->names ? snprintf(name, sizeof name, "%s", cut->names[i])
                       : snprintf(name, sizeof name, "%s-%u", query->surface->record->name, i + 1);
        if (length > PROTO_MESH_NAME)
            return proto_problem_refuse(
                problem, "/names", "the mesh's name is too long to be numbered; name the pieces");
        if (!server_derived_meshes_add(&cut->meshes, name, &cut->cut.pieces[i].polygons, NULL,
                                       problem))
            return false;
    }
    return true;
}

/* A name of our making must not replace another mesh. Returns such a name, or NULL. */
static const char *pieces_find_taken(const struct cut_query *cut)
{
    struct server_registry *registry = cut->own.query.exchange->host->api->registry;
    for (uint32_t i = 0; i < cut->meshes.count && !cut->names; i++) {
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

/* By the registry's writer, so that no other mesh is put meanwhile. */
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
    enum server_store_outcome outcome = server_derived_meshes_store(&cut->meshes);
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return true;
    }
    cut->is_stored = true;
    server_exchange_defer(exchange, cut->work, NULL);
    server_workers_resume(exchange->host->workers, &exchange->job);
    return false;
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_query_turn cut_solve(struct server_query *query, struct proto_problem *problem)
{
    static const struct server_curve_use use = {cut_make, "the cut"};
    struct cut_query *cut = (struct cut_query *)query;
    size_t edges = gd_mesh_summary(query->surface->mesh)->edges;
    if (cut->is_stored) return SERVER_QUERY_DONE;
    if (!server_curve_query_solve(&cut->own, &use, BYTES_A_CUT + edges * BYTES_AN_EDGE, problem))
        return SERVER_QUERY_FAILED;
    if (cut->select_only) return SERVER_QUERY_DONE;
    if (!pieces_build(cut, problem)) return SERVER_QUERY_FAILED;
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
        const char *name = cut->select_only ? NULL : cut->meshes.list[i].surface->record->name;
        proto_cut_piece_encode(writer, &cut->cut.pieces[i], name, fields);
    }
    proto_cut_end(writer, &cut->cut, fields);
}

static void cut_release(struct server_query *query)
{
    struct cut_query *cut = (struct cut_query *)query;
    if (cut->meshes.exchange) cut->meshes.exchange = query->exchange; /* a stream's, perhaps */
    server_derived_meshes_free(&cut->meshes);
    gd_cut_free(&cut->cut);
    proto_located_curve_free(&cut->own.curve);
    free(cut->names);
}

const struct server_query_kind server_query_cut = {.name = "cut",
                                                   .size = sizeof(struct cut_query),
                                                   .fields = proto_cut_fields,
                                                   .uses_landmarks = true,
                                                   .decode = cut_decode,
                                                   .solve = cut_solve,
                                                   .encode = cut_encode,
                                                   .release = cut_release};
