/* Tessellate and discretize: make a mesh resource from a smooth surface. The attachment of the mesh
 * contains the place of each vertex on the surface. A worker makes the mesh; the registry's writer
 * thread stores it. GET …/parameters (of NURBS), GET …/places (of subdivision surfaces) and GET
 * …/origins (of edited meshes) read the attachment. */
#include "server/api/smooth/smooth.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "proto/queries/made_mesh.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/surface_resource.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/surfaces/derived.h"
#include "server/surfaces/kinds.h"

/* bytes that most calls need */
#define TESSELLATE_BYTES ((size_t)8 << 20)
#define DISCRETIZE_BYTES ((size_t)16 << 20)

enum { NUMBERS_MOST = 4, VERTICES_PER_CHECK = 65536 };

/* --- the attachment --------------------------------------------------------------------------- */

/* The head of an attachment. The places follow, one for each vertex. All numbers are in the byte
 * order of this machine. */
struct head {
    char word[8]; /* without a NUL */
    char surface[PROTO_MESH_NAME + 8], etag[SERVER_ETAG + 7];
    double period[2]; /* NURBS only */
};

/* Format of the attachments for one kind of surface. */
struct format {
    char word[8];
    size_t head, item; /* bytes of the head, and of one vertex */
    uint32_t numbers;  /* how many numbers a vertex has */
    void (*read)(const void *item, double *out);
    const char *maker, *noun;
    /* names of members of the answer: the surface, and the numbers of all vertices */
    const char *surface, *member;
};

static void uv_read(const void *item, double *out)
{
    memcpy(out, item, 2 * sizeof *out);
}

static void place_read(const void *item, double *out)
{
    const struct gd_limit_point *place = item;
    out[0] = place->face, out[1] = place->corner, out[2] = place->u, out[3] = place->v;
}

static void origin_read(const void *item, double *out)
{
    memcpy(out, item, 4 * sizeof *out);
}

static const struct format nurbs_format = {.word = {'n', 'u', 'r', 'b', 's', 'u', 'v', '1'},
                                           .head = sizeof(struct head),
                                           .item = 2 * sizeof(double),
                                           .numbers = 2,
                                           .read = uv_read,
                                           .maker = "tessellate",
                                           .noun = "parameters",
                                           .surface = "nurbs",
                                           .member = "uv"},
                           limit_format = {.word = {'l', 'i', 'm', 'i', 't', 'u', 'v', '1'},
                                           .head = offsetof(struct head, period),
                                           .item = sizeof(struct gd_limit_point),
                                           .numbers = 4,
                                           .read = place_read,
                                           .maker = "discretize",
                                           .noun = "places",
                                           .surface = "subdivision",
                                           .member = "places"};

/* The attachments of edited meshes (derived.h), which begin like a head. */
static const struct format edit_format = {.word = {'d', 'e', 'r', 'i', 'v', 'e', 'd', '1'},
                                          .head = sizeof(struct server_derived),
                                          .item = 4 * sizeof(double),
                                          .numbers = 4,
                                          .read = origin_read,
                                          .maker = "derive",
                                          .noun = "origins",
                                          .surface = "mesh",
                                          .member = "origins"};

static_assert(offsetof(struct server_derived, mesh) == offsetof(struct head, surface) &&
                  offsetof(struct server_derived, etag) == offsetof(struct head, etag),
              "a mesh that edits made names its original as others do");
static_assert(offsetof(struct head, period) % _Alignof(struct gd_limit_point) == 0,
              "places follow their head");

static size_t attachment_size(const struct format *format, uint32_t vertices)
{
    return format->head + vertices * format->item;
}

static void *attachment_items(const struct format *format, const struct head *head)
{
    return (char *)head + format->head;
}

/* --- the mesh --------------------------------------------------------------------------------- */

struct meshing {
    struct server_query query; /* must be the first member */
    struct proto_tessellation tessellate;
    struct proto_discretization discretize;
    struct gd_tessellation *tessellation;
    struct gd_discretization discretization;
    struct gd_detail detail;
    struct server_derived_meshes meshes;
};

/* The arguments of meshing_add that depend on the kind of surface. */
struct mesher {
    const struct format *format;
    const char *name; /* name of the new mesh */
    const struct gd_polygons *polygons;
    enum gd_status (*write)(const struct meshing *meshing, const struct gd_control *control,
                            struct head *head);
};

static void meshing_release(struct server_query *query)
{
    struct meshing *meshing = (struct meshing *)query;
    server_derived_meshes_free(&meshing->meshes);
    gd_tessellation_release(meshing->tessellation);
    gd_discretization_free(&meshing->discretization);
}

static bool meshing_add(struct meshing *meshing, const struct mesher *mesher)
{
    struct proto_problem *problem = meshing->query.problem;
    struct server_exchange *exchange = meshing->query.exchange;
    const struct server_record *record = meshing->query.surface->record;
    struct server_budget *budget = exchange->host->budget;
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    struct server_attachment attachment;
    if (!server_attachment_create(&attachment,
                                  attachment_size(mesher->format, mesher->polygons->position_count),
                                  budget, problem))
        return false;
    struct head *head = attachment.bytes;
    memcpy(head->word, mesher->format->word, sizeof head->word);
    strcpy(head->surface, record->name);
    strcpy(head->etag, record->etag);
    enum gd_status status = mesher->write(meshing, &control, head);
    if (!status)
        return server_derived_meshes_add(
            &meshing->meshes, mesher->name,
            &(struct server_derived_source){.polygons = mesher->polygons,
                                            .attachment = &attachment},
            problem);
    server_attachment_free(&attachment, budget);
    return proto_problem_from_status(problem, status, NULL);
}

/* Runs on the registry's writer thread. */
static bool meshing_store(struct server_exchange *exchange)
{
    struct server_derived_meshes *meshes = &((struct meshing *)exchange->state)->meshes;
    enum server_outcome outcome = server_derived_meshes_store(meshes);
    server_surface_resource_reply_stored(exchange, meshes->list[0].surface, outcome);
    return true;
}

static enum server_query_turn meshing_end(struct meshing *meshing, const struct mesher *mesher)
{
    struct server_exchange *exchange = meshing->query.exchange;
    meshing->meshes.exchange = exchange;
    if (!meshing_add(meshing, mesher)) return SERVER_QUERY_FAILED;
    (void)server_request_write(exchange, meshing_store);
    return SERVER_QUERY_PARKED;
}

#define MESHING_STEPS .size = sizeof(struct meshing), .release = meshing_release

/* --- tessellate ------------------------------------------------------------------------------- */

static bool tessellate_decode(struct server_query *query, const json_t *document)
{
    uint32_t max_faces = (uint32_t)query->exchange->host->api->config->max_faces;
    return proto_tessellation_decode(document, max_faces, &((struct meshing *)query)->tessellate,
                                     query->problem);
}

static enum gd_status tessellate_write(const struct meshing *meshing,
                                       const struct gd_control *control, struct head *head)
{
    const struct gd_tessellation *tessellation = meshing->tessellation;
    const struct gd_parametric *surface = gd_tessellation_surface(tessellation);
    const struct gd_axis *axes[] = {gd_parametric_axis_u(surface), gd_parametric_axis_v(surface)};
    double(*uv)[2] = attachment_items(&nurbs_format, head);
    uint32_t count = gd_tessellation_polygons(tessellation)->position_count;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 2; k++)
        head->period[k] = axes[k]->closed ? axes[k]->high - axes[k]->low : 0;
    for (uint32_t i = 0; !status && i < count; i++) {
        if (i % VERTICES_PER_CHECK == 0) status = gd_control_check(control, 0);
        gd_tessellation_vertex(tessellation, (struct gd_vertex){i}, uv[i]);
    }
    return status;
}

static enum server_query_turn tessellate_solve(struct server_query *query)
{
    struct meshing *meshing = (struct meshing *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 0.5);
    struct server_budgeted_call call = server_query_begin_call(query, &monitor, TESSELLATE_BYTES);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_tessellation_build(server_nurbs_of(query->surface)->surface,
                                            &meshing->tessellate.options, &call.control,
                                            &meshing->tessellation, &meshing->detail);
        if (!call.status) call.kept = gd_tessellation_memsize(meshing->tessellation);
    }
    if (call.status) {
        server_query_fail(query, call.status, "the tessellation");
        if (call.status != GD_BUDGET)
            proto_problem_from_status(query->problem, call.status, &meshing->detail);
        if (call.status == GD_TOO_LARGE) {
            uint32_t most = meshing->tessellate.options.max_faces;
            if (most > GD_TESSELLATION_FACES_MAX) most = GD_TESSELLATION_FACES_MAX;
            proto_problem_exceed(query->problem, "/tolerance", most,
                                 "the tolerance needs more than %u triangles; choose a larger one",
                                 most);
        }
        return SERVER_QUERY_FAILED;
    }
    const struct mesher mesher = {&nurbs_format, meshing->tessellate.mesh.text,
                                  gd_tessellation_polygons(meshing->tessellation),
                                  tessellate_write};
    return meshing_end(meshing, &mesher);
}

const struct server_query_kind server_query_nurbs_tessellate = {
    .name = "tessellate", .decode = tessellate_decode, .solve = tessellate_solve, MESHING_STEPS};

/* --- discretize ------------------------------------------------------------------------------- */

static bool discretize_decode(struct server_query *query, const json_t *document)
{
    uint32_t max_faces = (uint32_t)query->exchange->host->api->config->max_faces;
    return proto_discretization_decode(document, server_subdivision_of(query->surface)->surface,
                                       max_faces, &((struct meshing *)query)->discretize,
                                       query->problem);
}

static size_t discretization_bytes(const struct gd_discretization *made)
{
    const struct gd_polygons *polygons = &made->polygons;
    return polygons->position_count *
               (sizeof *polygons->positions + sizeof *made->places + sizeof *made->normals) +
           gd_polygons_corner_count(polygons) * sizeof *polygons->corners;
}

/* number of places that are copied between two checks of the control */
#define COPY_PLACES ((size_t)1 << 16)

static enum gd_status discretize_write(const struct meshing *meshing,
                                       const struct gd_control *control, struct head *head)
{
    const struct gd_limit_point *from = meshing->discretization.places;
    struct gd_limit_point *to = attachment_items(&limit_format, head);
    size_t count = meshing->discretization.polygons.position_count;
    enum gd_status status = GD_OK;
    for (size_t i = 0; !status && i < count; i += COPY_PLACES) {
        memcpy(to + i, from + i, (count - i < COPY_PLACES ? count - i : COPY_PLACES) * sizeof *to);
        status = gd_control_check(control, 0);
    }
    return status;
}

static enum server_query_turn discretize_solve(struct server_query *query)
{
    struct meshing *meshing = (struct meshing *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 0.3);
    struct gd_discretization *made = &meshing->discretization;
    struct server_budgeted_call call = server_query_begin_call(query, &monitor, DISCRETIZE_BYTES);
    while (server_budgeted_call_next(&call)) {
        call.status =
            gd_discretize(server_subdivision_of(query->surface)->surface,
                          &meshing->discretize.options, &call.control, made, &meshing->detail);
        if (!call.status) call.kept = discretization_bytes(made);
    }
    if (call.status) {
        server_smooth_fail(query, call.status, &meshing->detail, "the discretization");
        if (call.status == GD_TOO_LARGE && meshing->discretize.options.tolerance > 0)
            proto_problem_at(query->problem, "/tolerance");
        return SERVER_QUERY_FAILED;
    }
    const struct mesher mesher = {&limit_format, meshing->discretize.mesh.text,
                                  &meshing->discretization.polygons, discretize_write};
    return meshing_end(meshing, &mesher);
}

const struct server_query_kind server_query_subdivision_discretize = {
    .name = "discretize", .decode = discretize_decode, .solve = discretize_solve, MESHING_STEPS};

/* --- GET …/parameters, GET …/places, GET …/origins -------------------------------------------- */

/* A query that reads an attachment. The constant of the query's kind (`own`) is the format. */
struct reading {
    struct server_query query; /* must be the first member */
    const struct head *head;
    uint32_t count; /* number of vertices */
};

static bool reading_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct reading *reading = (struct reading *)query;
    const struct format *format = query->kind->own;
    const struct server_surface *mesh = query->surface;
    (void)parameters; /* the request has no parameters */
    reading->head = mesh->attachment;
    reading->count = gd_mesh_summary(mesh->mesh)->index_count;
    if (reading->head && mesh->record->attachment_size == attachment_size(format, reading->count) &&
        memcmp(reading->head->word, format->word, sizeof format->word) == 0)
        return true;
    return proto_problem_set(query->problem, PROTO_PROBLEM_NOT_FOUND,
                             "the mesh '%s' was not made by %s, so its vertices have no %s",
                             mesh->record->name, format->maker, format->noun);
}

/* Makes a worker write the answer, which may be long. */
static enum server_query_turn reading_solve(struct server_query *query)
{
    (void)query;
    return SERVER_QUERY_DONE;
}

static void reading_read(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct reading *reading = source;
    const struct format *format = reading->query.kind->own;
    const char *item = (const char *)attachment_items(format, reading->head) + first * format->item;
    double *at = out;
    for (uint64_t i = 0; i < count; i++, item += format->item, at += format->numbers)
        format->read(item, at);
}

static struct server_array reading_array(const struct reading *reading)
{
    const struct format *format = reading->query.kind->own;
    return (struct server_array){.name = format->noun,
                                 .type = SERVER_ARRAY_NUMBERS,
                                 .columns = format->numbers,
                                 .rows = reading->count,
                                 .read = reading_read,
                                 .source = reading};
}

static bool reading_list_arrays(struct server_query *query)
{
    const struct server_array array = reading_array((const struct reading *)query);
    server_arrays_add(&query->arrays, &array);
    return true;
}

/* The first members of all three answers have the same bits. */
#define FIELD_SURFACE 1u
#define FIELD_NUMBERS 2u
static_assert(PROTO_VERTEX_PARAMETERS_FIELD_NURBS == FIELD_SURFACE &&
                  PROTO_VERTEX_PLACES_FIELD_SUBDIVISION == FIELD_SURFACE &&
                  PROTO_VERTEX_ORIGINS_FIELD_MESH == FIELD_SURFACE &&
                  PROTO_VERTEX_PLACES_FIELD_PLACES == FIELD_NUMBERS &&
                  PROTO_VERTEX_ORIGINS_FIELD_ORIGINS == FIELD_NUMBERS,
              "the surface is the first member");

static void reading_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct reading *reading = (const struct reading *)query;
    const struct format *format = query->kind->own;
    const struct server_array array = reading_array(reading);
    bool is_nurbs = format == &nurbs_format;
    uint32_t fields = query->options.fields,
             last = is_nurbs ? PROTO_VERTEX_PARAMETERS_FIELD_UV : FIELD_NUMBERS;
    proto_write_object_begin(writer);
    if (fields & FIELD_SURFACE)
        proto_made_of_encode(writer, format->surface, reading->head->surface, reading->head->etag);
    if (is_nurbs && fields & PROTO_VERTEX_PARAMETERS_FIELD_PERIODS) {
        const double *period = reading->head->period;
        const double periods[2] = {period[0] > 0 ? period[0] : NAN,
                                   period[1] > 0 ? period[1] : NAN};
        proto_member_numbers(writer, "periods", periods, 2);
    }
    if (fields & last) {
        proto_write_key(writer, format->member);
        server_array_encode(&array, writer);
    }
    proto_write_object_end(writer);
}

#define READING_STEPS                                                                              \
    .size = sizeof(struct reading), .parse = reading_parse, .solve = reading_solve,                \
    .encode = reading_encode, .has_bytes = true, .list_arrays = reading_list_arrays

const struct server_query_kind server_query_get_mesh_parameters = {
    .name = "parameters", .own = &nurbs_format, READING_STEPS};
const struct server_query_kind server_query_get_mesh_places = {
    .name = "places", .own = &limit_format, READING_STEPS};
const struct server_query_kind server_query_get_mesh_origins = {
    .name = "origins", .own = &edit_format, READING_STEPS};
