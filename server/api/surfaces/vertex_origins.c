/* See vertex_origins.h; and the two operations. */
#include "server/api/surfaces/vertex_origins.h"

#include <assert.h>
#include <endian.h>
#include <stdlib.h>
#include <string.h>

#include "proto/discretization.h"
#include "proto/tessellation.h"
#include "server/query/surface_resource.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/http/reply.h"
#include "server/query/api.h"

/* --- the attachment --------------------------------------------------------------------------- */

/* Before the origins, one a vertex index. Everything is as this machine has it in memory. */
struct head {
    char word[8]; /* without a NUL */
    char surface[PROTO_MESH_NAME + 8], etag[SERVER_ETAG + 7];
    double period[2]; /* parameters only */
};

/* What is told of the vertices of meshes of one kind of surface. */
struct origin {
    char word[8];
    size_t head, item; /* bytes of the head, and of one vertex */
    uint32_t numbers;  /* of one vertex */
    void (*tell)(const void *item, double *out);
    const char *maker, *noun;
};

static void tell_parameters(const void *item, double *out)
{
    memcpy(out, item, 2 * sizeof *out);
}

static void tell_place(const void *item, double *out)
{
    const struct gd_limit_point *place = item;
    out[0] = place->face, out[1] = place->corner, out[2] = place->u, out[3] = place->v;
}

enum { NUMBERS_MOST = 4, VERTICES_A_LOOK = 65536 };

static const struct origin parameters = {.word = {'n', 'u', 'r', 'b', 's', 'u', 'v', '1'},
                                         .head = sizeof(struct head),
                                         .item = 2 * sizeof(double),
                                         .numbers = 2,
                                         .tell = tell_parameters,
                                         .maker = "tessellate",
                                         .noun = "parameters"},
                           places = {.word = {'l', 'i', 'm', 'i', 't', 'u', 'v', '1'},
                                     .head = offsetof(struct head, period),
                                     .item = sizeof(struct gd_limit_point),
                                     .numbers = 4,
                                     .tell = tell_place,
                                     .maker = "discretize",
                                     .noun = "places"};

static_assert(offsetof(struct head, period) % _Alignof(struct gd_limit_point) == 0,
              "places follow their head");

static size_t cost_of(const struct origin *origin, uint32_t vertices)
{
    return origin->head + vertices * origin->item;
}

/* Malloc'ed, with room for the items; NULL without memory. */
static struct head *begin(const struct origin *origin, const struct server_record *surface,
                          uint32_t vertices)
{
    struct head *head = calloc(1, cost_of(origin, vertices));
    if (!head) return NULL;
    memcpy(head->word, origin->word, sizeof head->word);
    strcpy(head->surface, surface->name);
    strcpy(head->etag, surface->etag);
    return head;
}

static void *items_of(const struct origin *origin, const struct head *head)
{
    return (char *)head + origin->head;
}

/* A mesh's attachment if it is one of these, else NULL. */
static const struct head *find(const struct origin *origin, const struct server_surface *mesh)
{
    const struct head *head = mesh->attachment;
    size_t size = cost_of(origin, gd_mesh_summary(mesh->mesh)->index_count);
    bool is_one =
        head && mesh->record->attachment_size == size && memcmp(head->word, origin->word, 8) == 0;
    return is_one ? head : NULL;
}

/* --- making ----------------------------------------------------------------------------------- */

static double period_of(const struct gd_axis *axis)
{
    return axis->closed ? axis->high - axis->low : 0;
}

static enum gd_status write_parameters(const void *source, const struct gd_control *control,
                                       struct head *head)
{
    const struct gd_tessellation *tessellation = source;
    const struct gd_parametric *surface = gd_tessellation_surface(tessellation);
    double(*uv)[2] = items_of(&parameters, head);
    head->period[0] = period_of(gd_parametric_axis_u(surface));
    head->period[1] = period_of(gd_parametric_axis_v(surface));
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; !status && i < gd_tessellation_polygons(tessellation)->position_count;
         i++) {
        if (i % VERTICES_A_LOOK == 0) status = gd_control_check(control, 0);
        gd_tessellation_vertex(tessellation, (struct gd_vertex){i}, uv[i]);
    }
    return status;
}

static enum gd_status write_places(const void *source, const struct gd_control *control,
                                   struct head *head)
{
    const struct gd_discretization *fine = source;
    return server_derived_mesh_copy(items_of(&places, head), fine->places,
                                    fine->polygons.position_count * sizeof *fine->places, control);
}

/* A mesh to be made, and what writes its attachment's items. */
struct made {
    const struct origin *origin;
    const struct gd_polygons *polygons;
    enum gd_status (*write)(const void *source, const struct gd_control *control,
                            struct head *head);
    const void *source;
};

/* While it is made the attachment is there twice: the making has a copy of its own. */
static bool make(const struct server_query *query, const char *name, const struct made *made,
                 struct server_derived_meshes *making, struct proto_problem *problem)
{
    struct server_budget *budget = query->exchange->host->budget;
    size_t cost = cost_of(made->origin, made->polygons->position_count);
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(budget, "the mesh", cost, problem);
    struct head *head = begin(made->origin, query->surface->record, made->polygons->position_count);
    struct server_monitor monitor = {.exchange = query->exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    enum gd_status status = head ? made->write(made->source, &control, head) : GD_NO_MEMORY;
    const struct server_attachment attachment = {head, cost};
    bool ok = status
                  ? proto_problem_from_status(problem, status, NULL)
                  : server_derived_meshes_add(making, name, made->polygons, &attachment, problem);
    free(head);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, cost);
    return ok;
}

bool server_vertex_parameters_make(const struct server_query *query, const char *name,
                                   const struct gd_tessellation *tessellation,
                                   struct server_derived_meshes *making,
                                   struct proto_problem *problem)
{
    const struct made made = {&parameters, gd_tessellation_polygons(tessellation), write_parameters,
                              tessellation};
    return make(query, name, &made, making, problem);
}

bool server_vertex_places_make(const struct server_query *query, const char *name,
                               const struct gd_discretization *fine,
                               struct server_derived_meshes *making, struct proto_problem *problem)
{
    const struct made made = {&places, &fine->polygons, write_places, fine};
    return make(query, name, &made, making, problem);
}

bool server_vertex_origins_store(struct server_exchange *exchange,
                                 struct server_derived_meshes *making)
{
    enum server_store_outcome outcome = server_derived_meshes_store(making);
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return true;
    }
    struct server_surface *mesh = making->list[0].surface;
    const struct server_listed listed = {mesh->record, mesh};
    server_reply_header(exchange, "Location", "/v1/meshes/%s", mesh->record->name);
    server_surface_resource_reply(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &listed);
    return true;
}

/* --- the operations --------------------------------------------------------------------------- */

struct telling {
    struct server_query query; /* first */
    const struct origin *origin;
    const struct head *head;
    uint32_t count;
};

static bool parse(struct server_query *query, const struct origin *origin,
                  struct proto_problem *problem)
{
    struct telling *telling = (struct telling *)query;
    telling->origin = origin;
    telling->head = find(origin, query->surface);
    telling->count = gd_mesh_summary(query->surface->mesh)->index_count;
    if (telling->head) return true;
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_FOUND,
                             "the mesh '%s' was not made by %s, so its vertices have no %s",
                             query->surface->record->name, origin->maker, origin->noun);
}

static bool parse_parameters(struct server_query *query, const struct proto_parameters *unused,
                             struct proto_problem *problem)
{
    (void)unused;
    return parse(query, &parameters, problem);
}

static bool parse_places(struct server_query *query, const struct proto_parameters *unused,
                         struct proto_problem *problem)
{
    (void)unused;
    return parse(query, &places, problem);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    (void)query, (void)problem;
    return SERVER_QUERY_DONE;
}

static void encode_parameters(const struct server_query *query, struct proto_writer *writer)
{
    const struct telling *telling = (const struct telling *)query;
    const struct head *head = telling->head;
    const struct proto_vertex_parameters told = {.surface = head->surface,
                                                 .etag = head->etag,
                                                 .period = {head->period[0], head->period[1]},
                                                 .uv = items_of(&parameters, head),
                                                 .count = telling->count};
    proto_vertex_parameters_encode(writer, &told, query->options.fields);
}

static void encode_places(const struct server_query *query, struct proto_writer *writer)
{
    const struct telling *telling = (const struct telling *)query;
    const struct head *head = telling->head;
    const struct proto_vertex_places told = {.surface = head->surface,
                                             .etag = head->etag,
                                             .items = items_of(&places, head),
                                             .count = telling->count};
    proto_vertex_places_encode(writer, &told, query->options.fields);
}

/* Each vertex' numbers, little-endian. */
static size_t as_bytes(const struct server_query *query, void *out)
{
    const struct telling *telling = (const struct telling *)query;
    const struct origin *origin = telling->origin;
    const char *item = items_of(origin, telling->head);
    uint64_t *at = out;
    for (uint32_t i = 0; i < telling->count && out; i++, item += origin->item) {
        double numbers[NUMBERS_MOST];
        origin->tell(item, numbers);
        for (uint32_t k = 0; k < origin->numbers; k++, at++) {
            memcpy(at, &numbers[k], sizeof *at);
            *at = htole64(*at);
        }
    }
    return (size_t)telling->count * origin->numbers * sizeof *at;
}

/* The two forms have one ETag. */
static unsigned set_headers(struct server_query *query)
{
    server_reply_header(query->exchange, "Vary", "Accept");
    return 200;
}

#define TELLING_STEPS                                                                              \
    .size = sizeof(struct telling), .solve = solve, .bytes = as_bytes, .status = set_headers

static const struct server_query_kind parameters_kind = {.name = "parameters",
                                                         .fields = proto_vertex_parameters_fields,
                                                         .parse = parse_parameters,
                                                         .encode = encode_parameters,
                                                         TELLING_STEPS};
static const struct server_query_kind places_kind = {.name = "places",
                                                     .fields = proto_vertex_places_fields,
                                                     .parse = parse_places,
                                                     .encode = encode_places,
                                                     TELLING_STEPS};

void server_handle_get_mesh_parameters(struct server_exchange *exchange)
{
    server_query_handle(exchange, &parameters_kind);
}

void server_handle_get_mesh_places(struct server_exchange *exchange)
{
    server_query_handle(exchange, &places_kind);
}
