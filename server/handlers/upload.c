/* Upload: the bytes of a file become a mesh under a name. Read and built by a worker.
 *
 * Memory is taken from the budget step by step, each time before it is used: for the text while it arrives
 * (body.h), for the polygons while it is read, for the mesh while it is built. */
#include "server/handlers/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/reply.h"
#include "server/server.h"

#define READ_FACTOR    8  /* bytes that reading takes at most for each byte of the file */
#define GENERATED_NAME 32 /* hexadecimal digits */

struct upload {
    struct server_surface_origin origin; /* name empty: to be made from the bytes */
    struct gd_polygons polygons;
    size_t polygon_bytes; /* in SERVER_BUDGET_FLIGHT */
    struct server_budget *budget;
};

static void free_upload(void *state)
{
    struct upload *upload = state;
    gd_polygons_free(&upload->polygons);
    server_budget_give(upload->budget, SERVER_BUDGET_FLIGHT, upload->polygon_bytes);
    free(upload);
}

static void reply_status(struct server_exchange *exchange, enum gd_status status, const struct gd_detail *detail)
{
    struct proto_problem problem;
    proto_problem_from_status(&problem, status, detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(&problem, exchange->server->config.max_faces);
    server_reply_problem(exchange, &problem);
}

static void reply_over_budget(struct server_exchange *exchange, size_t bytes)
{
    struct proto_problem problem;
    server_budget_refuse(&exchange->server->budget, "the mesh", bytes, &problem);
    server_reply_problem(exchange, &problem);
}

/* --- steps, each replies when it fails ---------------------------------------------------------------------------- */

static size_t polygons_size(const struct gd_polygons *polygons)
{
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners;
}

static bool read_polygons(struct server_exchange *exchange, struct upload *upload)
{
    const struct gd_read_limits limits = {.max_faces = (uint32_t)exchange->server->config.max_faces};
    struct gd_detail detail = {0};
    size_t cost = exchange->body.size * READ_FACTOR;
    if (!server_budget_take(upload->budget, SERVER_BUDGET_FLIGHT, cost)) {
        reply_over_budget(exchange, cost);
        return false;
    }
    enum gd_status status = gd_read_polygons(exchange->body.bytes, exchange->body.size, upload->origin.options.format,
                                             &limits, &upload->polygons, &detail);
    upload->polygon_bytes = status ? 0 : polygons_size(&upload->polygons);
    server_budget_adjust(upload->budget, SERVER_BUDGET_FLIGHT, cost, upload->polygon_bytes);
    if (status) reply_status(exchange, status, &detail);
    return !status;
}

static size_t build_cost(const struct gd_polygons *polygons)
{
    uint64_t triangles = gd_polygons_corner_count(polygons) - UINT64_C(2) * polygons->polygon_count;
    return gd_mesh_build_cost(triangles, polygons->position_count);
}

/* The mesh, with `*bytes` of SERVER_BUDGET_FLIGHT held for it; NULL: replied. */
static struct gd_mesh *build_mesh(struct server_exchange *exchange, struct upload *upload, size_t *bytes)
{
    struct server_monitor monitor = {.exchange = exchange};
    struct gd_detail detail = {0};
    struct gd_mesh *mesh = NULL;
    size_t cost = build_cost(&upload->polygons);
    if (!server_budget_take(upload->budget, SERVER_BUDGET_FLIGHT, cost)) {
        reply_over_budget(exchange, cost);
        return NULL;
    }
    struct gd_control control = server_exchange_control(&monitor, cost);
    enum gd_status status = gd_mesh_build(&upload->polygons, &upload->origin.options.build, &control, &mesh, &detail);
    *bytes = status ? 0 : gd_mesh_memsize(mesh);
    server_budget_adjust(upload->budget, SERVER_BUDGET_FLIGHT, cost, *bytes);
    if (status) reply_status(exchange, status, &detail);
    return mesh;
}

static struct server_surface *make_surface(struct server_exchange *exchange, struct upload *upload)
{
    size_t bytes;
    struct gd_mesh *mesh = build_mesh(exchange, upload, &bytes);
    if (!mesh) return NULL;
    struct server_surface *surface =
        server_surface_create(&upload->origin, mesh, bytes, upload->budget, exchange->server->cache);
    if (surface) return surface;
    gd_mesh_release(mesh);
    server_budget_give(upload->budget, SERVER_BUDGET_FLIGHT, bytes);
    reply_status(exchange, GD_NO_MEMORY, NULL);
    return NULL;
}

static void reply_surface(struct server_exchange *exchange, unsigned status, struct server_surface *surface)
{
    server_reply_header(exchange, "Location", "/v1/meshes/%s", surface->origin.name);
    server_description_reply(exchange, status, surface);
}

/* Replies when the name holds the same mesh already, or something that the precondition excludes. */
static bool answer_from_store(struct server_exchange *exchange, const struct upload *upload)
{
    struct server_store *store = exchange->server->store;
    const struct server_precondition precondition = server_request_precondition(exchange);
    struct server_surface *before = store->get(store, upload->origin.name);
    bool excluded = !server_precondition_holds(&precondition, before ? before->etag : NULL);
    bool same = before && server_surface_origin_equal(&before->origin, &upload->origin);
    if (excluded)
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
    else if (same)
        reply_surface(exchange, 200, before);
    server_surface_release(before);
    return excluded || same;
}

static void store_surface(struct server_exchange *exchange, struct server_surface *surface)
{
    struct server_store *store = exchange->server->store;
    const struct server_precondition precondition = server_request_precondition(exchange);
    enum server_store_outcome outcome =
        store->put(store, surface, exchange->body.bytes, exchange->body.size, &precondition);
    if (outcome == SERVER_STORE_CREATED)
        reply_surface(exchange, 201, surface);
    else if (outcome == SERVER_STORE_REPLACED)
        reply_surface(exchange, 200, surface);
    else
        server_request_fail(exchange, outcome);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void identify(const struct server_exchange *exchange, struct server_surface_origin *origin)
{
    const struct server_body *body = &exchange->body;
    server_sha256(body->bytes, body->size, origin->sha256);
    if (!origin->name[0]) snprintf(origin->name, sizeof origin->name, "%.*s", GENERATED_NAME, origin->sha256);
    origin->options.format = proto_mesh_upload_format(&origin->options, body->bytes, body->size,
                                                      server_exchange_header(exchange, "Content-Type"));
}

static bool make_mesh(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    identify(exchange, &upload->origin);
    if (answer_from_store(exchange, upload) || !read_polygons(exchange, upload)) return true;
    struct server_surface *surface = make_surface(exchange, upload);
    if (!surface) return true;
    store_surface(exchange, surface);
    server_surface_release(surface);
    server_body_drop(&exchange->body, upload->budget);
    return true;
}

static void handle_upload(struct server_exchange *exchange, const char *name)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    if (!server_reply_accepts_json(exchange)) return;
    struct upload *upload = calloc(1, sizeof *upload);
    if (!upload) {
        reply_status(exchange, GD_NO_MEMORY, NULL);
        return;
    }
    upload->budget = &exchange->server->budget;
    strcpy(upload->origin.name, name);
    server_exchange_keep(exchange, upload, free_upload);
    if (proto_mesh_options_parse(&parameters, &upload->origin.options, &problem))
        server_exchange_defer(exchange, make_mesh, NULL);
    else
        server_reply_problem(exchange, &problem);
}

void server_handle_create_mesh(struct server_exchange *exchange)
{
    handle_upload(exchange, "");
}

void server_handle_put_mesh(struct server_exchange *exchange)
{
    char name[PROTO_MESH_NAME + 1];
    if (server_request_name(exchange, name)) handle_upload(exchange, name);
}
