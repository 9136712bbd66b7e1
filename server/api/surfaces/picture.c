/* Picture: renders a surface, a field on it, a path and layers as a PNG, SVG or GLB file. Always
 * runs on a worker. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/http/accept.h"
#include "proto/queries/picture.h"
#include "server/api/surfaces/picture_layers.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/query.h"
#include "server/work/executor.h"

/* bytes that most pictures need */
#define PICTURE_BYTES   ((size_t)8 << 20)
#define BYTES_PER_FACE  100
#define BYTES_PER_EDGE  32 /* bytes needed for each edge while an isoline is traced */
#define BYTES_PER_PIXEL 32

#define PATH_SHARE   0.3 /* shares of the work, for the progress of a job */
#define LAYERS_SHARE 0.5
#define MESH_SHARE   0.3

struct format {
    struct server_query_kind kind; /* must be the first member */
    const char *media_type;
    const char *policy; /* Content-Security-Policy; NULL means the default policy for data */
    enum gd_status (*render)(const struct gd_picture *picture, const struct gd_control *control,
                             void **bytes, size_t *size);
};

struct picture {
    struct server_query query; /* must be the first member */
    struct proto_picture wanted;
    struct gd_pair_answer route;
    struct server_picture_layers layers;
    struct server_picture_surface surface;
    void *file; /* NULL if not rendered yet, or already sent */
    size_t size;
};

static void picture_release(struct server_query *query)
{
    struct picture *picture = (struct picture *)query;
    free(picture->file);
    server_picture_layers_free(&picture->layers);
    server_picture_surface_close(&picture->surface);
    gd_pair_answer_free(&picture->route);
    proto_picture_free(&picture->wanted);
}

static bool picture_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct picture *picture = (struct picture *)query;
    struct proto_picture *wanted = &picture->wanted;
    struct proto_set set;
    if (!proto_picture_parse(parameters, wanted, query->problem)) return false;
    if (wanted->stops.count && !server_query_locate(query, &wanted->stops)) return false;
    if (wanted->field) return server_field_query_of_id(query, wanted->field);
    return !wanted->has_source || (proto_set_of_point(&wanted->source, &set, query->problem) &&
                                   server_field_query_of_set(query, &set, 0));
}

static bool picture_decode(struct server_query *query, const json_t *document)
{
    struct picture *picture = (struct picture *)query;
    struct proto_picture *wanted = &picture->wanted;
    if (!proto_picture_decode(document, wanted, query->problem)) return false;
    picture->layers.wanted = &wanted->request.layers;
    picture->layers.surface = &picture->surface;
    return server_picture_layers_decode(&picture->layers, query, document);
}

/* --- the scene -------------------------------------------------------------------------------- */

/* Computes the path through the points of the route. */
static bool picture_find_route(struct picture *picture)
{
    struct server_query *query = &picture->query;
    uint32_t legs = query->points.count ? query->points.count - 1 : 0;
    for (uint32_t i = 0; i < legs; i++) {
        struct server_monitor part =
            server_query_monitor(query, PATH_SHARE * i / legs, PATH_SHARE / legs);
        const struct server_pair pair = {&query->points.points[i], &query->points.points[i + 1],
                                         GD_PAIR_PATH};
        struct gd_pair_answer leg;
        enum gd_status status = server_pair_solve(&part, query->surface, &pair, &leg);
        if (!status) status = server_pair_append(&picture->route, &leg);
        if (status) return server_query_refuse(query, status, "the search");
    }
    return !isinf(picture->route.distance) ||
           proto_problem_refuse(
               picture->query.problem, "to",
               "no path leads there: the points lie in different components of the mesh; leave out "
               "from and to, or name others");
}

static enum server_query_turn picture_draw(struct server_query *query, const struct gd_field *field)
{
    struct picture *picture = (struct picture *)query;
    const struct format *format = (const struct format *)query->kind;
    struct server_monitor part = server_query_monitor(query, PATH_SHARE, 1 - PATH_SHARE);
    struct gd_picture *wanted = &picture->wanted.picture;
    if (!server_picture_surface_open(&picture->surface, query, MESH_SHARE) ||
        !picture_find_route(picture))
        return SERVER_QUERY_FAILED;
    const struct gd_mesh_summary *summary = gd_mesh_summary(picture->surface.mesh);
    if (!field) field = picture->surface.field;
    wanted->mesh = picture->surface.mesh;
    wanted->field = field;
    wanted->path = picture->route.path.count ? &picture->route.path : NULL;
    wanted->layers = picture->layers.drawn;
    wanted->layer_count = picture->layers.count;
    size_t bytes = PICTURE_BYTES + (size_t)wanted->width * wanted->height * BYTES_PER_PIXEL +
                   (size_t)summary->faces * BYTES_PER_FACE +
                   (field ? (size_t)summary->edges * BYTES_PER_EDGE : 0);
    struct server_budgeted_call call = server_query_begin_call(query, &part, bytes);
    call.control.executor = server_executor_start_for(
        query->exchange->host->workers, summary->faces, query->exchange->job.deadline_ns);
    while (server_budgeted_call_next(&call)) {
        call.status = format->render(wanted, &call.control, &picture->file, &picture->size);
        call.kept = picture->size;
    }
    server_executor_stop(call.control.executor);
    if (call.status == GD_INVALID_ARGUMENT) {
        /* all other members have been checked */
        proto_problem_refuse(query->problem, wanted->target ? "/camera/target" : "/layers",
                             "%s is too far from the surface; it is at most %g times the size of "
                             "the surface away",
                             wanted->target ? "the target" : "a point of a layer",
                             GD_PICTURE_FARTHEST);
        return SERVER_QUERY_FAILED;
    }
    if (call.status) return server_query_fail_file(query, call.status, "the picture");
    query->held -= picture->size; /* the response takes the file over from the exchange */
    query->exchange->held += picture->size;
    return SERVER_QUERY_DONE;
}

/* Solves the layers before this query claims its field. Otherwise a layer that needs the same field
 * would wait for ever, because this query would have to build the field first. */
static enum server_query_turn picture_solve(struct server_query *query)
{
    struct picture *picture = (struct picture *)query;
    if (picture->layers.wanted) {
        enum server_query_turn turn =
            server_picture_layers_solve(&picture->layers, query, LAYERS_SHARE);
        if (turn != SERVER_QUERY_DONE) return turn;
        query->begun = LAYERS_SHARE;
        query->share = 1 - LAYERS_SHARE;
    }
    bool has_field = picture->wanted.field || picture->wanted.has_source || picture->layers.has_set;
    return has_field ? server_field_query_solve(query) : picture_draw(query, NULL);
}

static bool picture_join(struct server_query *query)
{
    return !((struct picture *)query)->layers.wanted && server_field_query_join(query);
}

static void picture_reply(struct server_query *query)
{
    struct picture *picture = (struct picture *)query;
    const struct format *format = (const struct format *)query->kind;
    void *file = picture->file;
    picture->file = NULL;
    query->exchange->response.policy = format->policy;
    server_reply_bytes(query->exchange, 200, format->media_type, file, picture->size);
}

#define PICTURE_STEPS                                                                              \
    .size = sizeof(struct picture), .parse = picture_parse, .decode = picture_decode,              \
    .join = picture_join, .solve = picture_solve, .answer = picture_draw, .reply = picture_reply,  \
    .release = picture_release

static void picture_handle(struct server_exchange *exchange, const struct format *format)
{
    if (proto_accept_quality(server_exchange_header(exchange, "Accept"), format->media_type))
        server_query_handle(exchange, &format->kind);
    else
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "the answer is %s, which Accept excludes", format->media_type);
}

static const struct format png = {
    .kind = {.name = "picture.png", .reply_form = "png", PICTURE_STEPS},
    .media_type = "image/png",
    .render = gd_picture_png};

/* when opened as a page, the file may show only the image that it embeds */
static const struct format svg = {
    .kind = {.name = "picture.svg", .reply_form = "svg", PICTURE_STEPS},
    .media_type = "image/svg+xml",
    .policy = "default-src 'none'; img-src data:; sandbox",
    .render = gd_picture_svg};

static const struct format glb = {
    .kind = {.name = "picture.glb", .reply_form = "glb", PICTURE_STEPS},
    .media_type = "model/gltf-binary",
    .render = gd_picture_glb};

void server_handle_picture_png(struct server_exchange *exchange)
{
    picture_handle(exchange, &png);
}

void server_handle_picture_svg(struct server_exchange *exchange)
{
    picture_handle(exchange, &svg);
}

/* Chooses the format by ?format= if given, otherwise by Accept. In a tie, chooses the format that
 * comes first in the list. */
void server_handle_picture(struct server_exchange *exchange)
{
    static const struct format *const formats[] = {&png, &svg, &glb};
    enum { FORMATS = sizeof formats / sizeof *formats };
    const char *accept = server_exchange_header(exchange, "Accept");
    struct proto_problem problem;
    unsigned best = 0;
    for (unsigned i = 1; i < FORMATS; i++)
        if (proto_accept_quality(accept, formats[i]->media_type) >
            proto_accept_quality(accept, formats[best]->media_type))
            best = i;
    bool is_given = proto_parameters_get(&exchange->parameters, "format") != NULL;
    if (!server_reply_check(exchange,
                            proto_parameters_choice(&exchange->parameters, "format",
                                                    proto_picture_format_words, &best, &problem),
                            &problem))
        return;
    if (is_given)
        server_query_handle(exchange, &formats[best]->kind);
    else
        picture_handle(exchange, formats[best]);
}
