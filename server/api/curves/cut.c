/* Cut: a mesh along a curve. A worker cuts it and builds the pieces, the registry's writer stores
 * them, a worker writes the answer. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/cut.h"
#include "server/query/curve_call.h"
#include "server/query/derived_mesh.h"
#include "server/query/query.h"
#include "server/query/request.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define BYTES_AN_EDGE 320 /* a search for the curve, or the cut and its pieces */
#define BYTES_A_CUT   ((size_t)1 << 20)
#define CURVE_SHARE   0.5 /* of the work */

struct cut {
    struct server_query query; /* first */
    struct proto_located_curve curve;
    bool has_inside, select_only;
    struct gd_point inside;
    char (*names)[PROTO_MESH_NAME + 1]; /* NULL: none were given */
    uint32_t name_count;

    struct gd_cut cut;
    struct server_derived_meshes meshes;
    bool is_stored;
    /* of the query, which goes on after the meshes are stored */
    bool (*work)(struct server_exchange *exchange);
};

/* --- the cut ---------------------------------------------------------------------------------- */

static enum gd_status cut_mesh(struct server_query *query, struct gd_curve *curve,
                               const struct gd_control *control, struct gd_detail *detail,
                               size_t *kept)
{
    struct cut *cut = (struct cut *)query;
    const struct gd_cut_request request = {.curve = curve,
                                           .inside = cut->has_inside ? &cut->inside : NULL,
                                           .select_only = cut->select_only};
    enum gd_status status =
        gd_cut_along(query->surface->mesh, &request, control, &cut->cut, detail);
    if (!status) *kept = cut->cut.bytes;
    return status;
}

static bool make_cut(struct cut *cut, struct proto_problem *problem)
{
    size_t edges = gd_mesh_summary(cut->query.surface->mesh)->edges;
    const struct server_curve_call call = {.curve = &cut->curve,
                                           .make = cut_mesh,
                                           .grant = BYTES_A_CUT + edges * BYTES_AN_EDGE,
                                           .share = CURVE_SHARE,
                                           .what = "the cut"};
    return server_curve_call_make(&cut->query, &call, problem);
}

/* --- the meshes ------------------------------------------------------------------------------- */

static bool check_count(const struct cut *cut, struct proto_problem *problem)
{
    uint32_t count = cut->cut.piece_count;
    if (cut->names && count != cut->name_count)
        return proto_problem_refuse(problem, "/names",
                                    "the cut gives %u pieces, and there are %u names", count,
                                    cut->name_count);
    if (count <= SERVER_DERIVED_MESHES_MOST) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "the cut gives %u pieces, and at most %d become meshes at a time; choose one "
                      "by \"inside\", or ask "
                      "with \"select_only\"",
                      count, SERVER_DERIVED_MESHES_MOST);
    return proto_problem_limit(problem, SERVER_DERIVED_MESHES_MOST);
}

/* The i-th piece's name, that which was given or the parent's with a number. False: that is too
 * long. */
static bool name_piece(const struct cut *cut, uint32_t i, char name[PROTO_MESH_NAME + 1],
                       struct proto_problem *problem)
{
    int length = cut->names ? snprintf(name, PROTO_MESH_NAME + 1, "%s", cut->names[i])
                            : snprintf(name, PROTO_MESH_NAME + 1, "%s-%u",
                                       cut->query.surface->record->name, i + 1);
    return length <= PROTO_MESH_NAME ||
           proto_problem_refuse(problem, "/names",
                                "the mesh's name is too long to be numbered; name the pieces");
}

static bool make_meshes(struct cut *cut, struct proto_problem *problem)
{
    if (!check_count(cut, problem)) return false;
    server_derived_meshes_begin(&cut->meshes, cut->query.exchange);
    for (uint32_t i = 0; i < cut->cut.piece_count; i++) {
        char name[PROTO_MESH_NAME + 1];
        if (!name_piece(cut, i, name, problem) ||
            !server_derived_meshes_add(&cut->meshes, name, &cut->cut.pieces[i].polygons, NULL,
                                       problem))
            return false;
    }
    return true;
}

/* A name that nobody gave must not take another mesh's place. NULL: none does. */
static const char *find_taken(const struct cut *cut)
{
    struct server_registry *registry = cut->query.exchange->host->api->registry;
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

/* By the writer: nobody else puts meshes meanwhile. */
static bool store(struct server_exchange *exchange)
{
    struct cut *cut = exchange->state;
    const char *taken = find_taken(cut);
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

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct cut *cut = (struct cut *)query;
    struct proto_cut wanted;
    double snap;
    if (!proto_cut_decode(document, &wanted, problem)) return false;
    bool ok = proto_curve_locate(query->surface->mesh, &wanted.curve, &cut->curve, problem) &&
              (!wanted.has_inside || proto_point_locate(query->surface->mesh, &wanted.inside,
                                                        &cut->inside, &snap, problem));
    cut->has_inside = wanted.has_inside;
    cut->select_only = wanted.select_only;
    cut->names = wanted.names;
    cut->name_count = wanted.name_count;
    wanted.names = NULL;
    proto_cut_free(&wanted);
    return ok;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct cut *cut = (const struct cut *)query;
    uint32_t fields = query->options.fields;
    proto_cut_begin(writer, &cut->cut, fields);
    for (uint32_t i = 0; i < cut->cut.piece_count; i++) {
        const char *name = cut->select_only ? NULL : cut->meshes.list[i].surface->record->name;
        proto_cut_piece_encode(writer, &cut->cut.pieces[i], name, fields);
    }
    proto_cut_end(writer, &cut->cut, fields);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct cut *cut = (struct cut *)query;
    if (cut->is_stored) return SERVER_QUERY_DONE;
    if (!make_cut(cut, problem)) return SERVER_QUERY_FAILED;
    if (cut->select_only) return SERVER_QUERY_DONE;
    if (!make_meshes(cut, problem)) return SERVER_QUERY_FAILED;
    cut->work = query->exchange->work;
    (void)server_request_write(query->exchange, store);
    return SERVER_QUERY_PARKED;
}

static void release(struct server_query *query)
{
    struct cut *cut = (struct cut *)query;
    if (cut->meshes.exchange) cut->meshes.exchange = query->exchange; /* of a stream, perhaps */
    server_derived_meshes_free(&cut->meshes);
    gd_cut_free(&cut->cut);
    proto_located_curve_free(&cut->curve);
    free(cut->names);
}

static const struct server_query_kind cut_kind = {.name = "cut",
                                                  .size = sizeof(struct cut),
                                                  .fields = proto_cut_fields,
                                                  .decode = decode,
                                                  .solve = solve,
                                                  .encode = encode,
                                                  .release = release};

void server_handle_cut(struct server_exchange *exchange)
{
    server_query_handle(exchange, &cut_kind);
}
