/* See vertex_places.h; and GET …/places, which answers them. */
#include "server/handlers/vertex_places.h"

#include <endian.h>
#include <stdlib.h>
#include <string.h>

#include "server/handlers/handlers.h"
#include "server/handlers/query.h"
#include "server/reply.h"
#include "server/server.h"

/* --- the attachment ----------------------------------------------------------------------------------------------- */

static const char word[8] = "limituv1";

/* Before the places, one a vertex index. Everything is as this machine has it in memory. */
struct head {
    char word[8]; /* without a NUL */
    char surface[PROTO_MESH_NAME + 8], etag[SERVER_ETAG + 7];
};

size_t server_vertex_places_cost(uint32_t vertices)
{
    return sizeof(struct head) + vertices * sizeof(struct gd_limit_point);
}

void *server_vertex_places_write(const struct server_record *surface, const struct gd_discretization *fine)
{
    uint32_t count = fine->polygons.position_count;
    struct head *head = calloc(1, server_vertex_places_cost(count));
    if (!head) return NULL;
    memcpy(head->word, word, sizeof word);
    strcpy(head->surface, surface->name);
    strcpy(head->etag, surface->etag);
    memcpy(head + 1, fine->places, count * sizeof *fine->places);
    return head;
}

bool server_vertex_places_read(const struct server_surface *mesh, struct proto_vertex_places *out)
{
    const struct head *head = mesh->attachment;
    uint32_t count = gd_mesh_summary(mesh->mesh)->index_count;
    if (!head || mesh->record->attachment_size != server_vertex_places_cost(count) ||
        memcmp(head->word, word, sizeof word) != 0)
        return false;
    *out = (struct proto_vertex_places){.surface = head->surface,
                                        .etag = head->etag,
                                        .items = (const struct gd_limit_point *)(head + 1),
                                        .count = count};
    return true;
}

/* --- the operation ------------------------------------------------------------------------------------------------ */

#define BYTES_A_VERTEX 100 /* of the answer's text, or its float64 */

struct telling {
    struct server_query query; /* first */
    struct proto_vertex_places places;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for the answer */
};

static bool parse(struct server_query *query, const struct proto_parameters *parameters, struct proto_problem *problem)
{
    (void)parameters;
    if (server_vertex_places_read(query->surface, &((struct telling *)query)->places)) return true;
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_FOUND,
                             "the mesh '%s' was not made by discretize, so its vertices have no places",
                             query->surface->record->name);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct telling *telling = (struct telling *)query;
    size_t bytes = telling->places.count * (size_t)BYTES_A_VERTEX;
    if (!server_budget_take(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, bytes))
        return server_query_fail(query, GD_BUDGET, "the answer", problem);
    telling->held = bytes;
    return SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_vertex_places_encode(writer, &((const struct telling *)query)->places, query->options.fields);
}

static uint64_t little_endian(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return htole64(bits);
}

/* Four numbers a vertex, little-endian. */
static void *as_bytes(const struct server_query *query, size_t *size)
{
    const struct proto_vertex_places *places = &((const struct telling *)query)->places;
    size_t bytes = 4 * (size_t)places->count * sizeof(uint64_t);
    uint64_t *out = malloc(bytes);
    if (!out) return NULL;
    for (uint32_t i = 0; i < places->count; i++) {
        const struct gd_limit_point *place = &places->items[i];
        const double numbers[4] = {place->face, place->corner, place->u, place->v};
        for (int k = 0; k < 4; k++) out[4 * (size_t)i + (size_t)k] = little_endian(numbers[k]);
    }
    *size = bytes;
    return out;
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

static const struct server_query_kind places_kind = {.name = "places",
                                                     .size = sizeof(struct telling),
                                                     .fields = proto_vertex_places_fields,
                                                     .parse = parse,
                                                     .solve = solve,
                                                     .encode = encode,
                                                     .bytes = as_bytes,
                                                     .release = release,
                                                     .status = set_headers};

void server_handle_get_mesh_places(struct server_exchange *exchange)
{
    server_query_handle(exchange, &places_kind);
}
