/* See vertex_parameters.h; and GET …/parameters, which answers them. */
#include "server/handlers/vertex_parameters.h"

#include <endian.h>
#include <stdlib.h>
#include <string.h>

#include "server/handlers/handlers.h"
#include "server/handlers/query.h"
#include "server/reply.h"
#include "server/server.h"

/* --- the attachment ----------------------------------------------------------------------------------------------- */

static const char word[8] = "nurbsuv1";

/* Before the pairs (u, v), one a vertex index. Everything is as this machine has it in memory. */
struct head {
    char word[8]; /* without a NUL */
    char surface[PROTO_MESH_NAME + 8], etag[SERVER_ETAG + 7];
    double period[2];
};

static uint32_t vertex_count(const struct gd_tessellation *tessellation)
{
    return gd_tessellation_polygons(tessellation)->position_count;
}

size_t server_vertex_parameters_cost(const struct gd_tessellation *tessellation)
{
    return sizeof(struct head) + vertex_count(tessellation) * 2 * sizeof(double);
}

static double period_of(const struct gd_axis *axis)
{
    return axis->closed ? axis->high - axis->low : 0;
}

void *server_vertex_parameters_write(const struct server_record *surface, const struct gd_tessellation *tessellation,
                                     size_t *size)
{
    const struct gd_parametric *parametric = gd_tessellation_surface(tessellation);
    struct head *head = calloc(1, server_vertex_parameters_cost(tessellation));
    if (!head) return NULL;
    double(*uv)[2] = (double(*)[2])(head + 1);
    memcpy(head->word, word, sizeof word);
    strcpy(head->surface, surface->name);
    strcpy(head->etag, surface->etag);
    head->period[0] = period_of(gd_parametric_axis_u(parametric));
    head->period[1] = period_of(gd_parametric_axis_v(parametric));
    for (uint32_t i = 0; i < vertex_count(tessellation); i++)
        gd_tessellation_vertex(tessellation, (struct gd_vertex){i}, uv[i]);
    *size = server_vertex_parameters_cost(tessellation);
    return head;
}

bool server_vertex_parameters_read(const struct server_surface *mesh, struct proto_vertex_parameters *out)
{
    const struct head *head = mesh->attachment;
    uint32_t count = gd_mesh_summary(mesh->mesh)->index_count;
    size_t size = sizeof *head + count * 2 * sizeof(double);
    if (!head || mesh->record->attachment_size != size || memcmp(head->word, word, sizeof word) != 0) return false;
    *out = (struct proto_vertex_parameters){.surface = head->surface,
                                            .etag = head->etag,
                                            .period = {head->period[0], head->period[1]},
                                            .uv = (const double(*)[2])(head + 1),
                                            .count = count};
    return true;
}

/* --- the operation ------------------------------------------------------------------------------------------------ */

#define BYTES_A_VERTEX 80 /* of the answer's text, or its float64 */

struct telling {
    struct server_query query; /* first */
    struct proto_vertex_parameters parameters;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for the answer */
};

static bool parse(struct server_query *query, const struct proto_parameters *parameters, struct proto_problem *problem)
{
    (void)parameters;
    if (server_vertex_parameters_read(query->surface, &((struct telling *)query)->parameters)) return true;
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_FOUND,
                             "the mesh '%s' was not made by tessellate, so its vertices have no parameters",
                             query->surface->record->name);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct telling *telling = (struct telling *)query;
    size_t bytes = telling->parameters.count * (size_t)BYTES_A_VERTEX;
    if (!server_budget_take(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, bytes))
        return server_query_fail(query, GD_BUDGET, "the answer", problem);
    telling->held = bytes;
    return SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_vertex_parameters_encode(writer, &((const struct telling *)query)->parameters, query->options.fields);
}

/* The pairs, little-endian. */
static void *as_bytes(const struct server_query *query, size_t *size)
{
    const struct proto_vertex_parameters *parameters = &((const struct telling *)query)->parameters;
    size_t count = 2 * (size_t)parameters->count;
    uint64_t *bytes = malloc(count * sizeof *bytes);
    if (!bytes) return NULL;
    memcpy(bytes, parameters->uv, count * sizeof *bytes);
    for (size_t i = 0; i < count; i++) bytes[i] = htole64(bytes[i]);
    *size = count * sizeof *bytes;
    return bytes;
}

/* The two forms have one ETag. */
static unsigned set_headers(struct server_query *query)
{
    server_reply_header(query->exchange, "Vary", "Accept");
    return 200;
}

static void release(struct server_query *query)
{
    server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, ((struct telling *)query)->held);
}

static const struct server_query_kind parameters_kind = {.name = "parameters",
                                                         .size = sizeof(struct telling),
                                                         .fields = proto_vertex_parameters_fields,
                                                         .parse = parse,
                                                         .solve = solve,
                                                         .encode = encode,
                                                         .bytes = as_bytes,
                                                         .release = release,
                                                         .status = set_headers};

void server_handle_get_mesh_parameters(struct server_exchange *exchange)
{
    server_query_handle(exchange, &parameters_kind);
}
