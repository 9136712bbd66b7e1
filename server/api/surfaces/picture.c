/* Picture: a mesh, a field on it and a path, as a PNG or SVG file. Always by a worker. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/accept.h"
#include "proto/picture.h"
#include "server/work/budgeted_call.h"
#include "server/query/field_query.h"
#include "server/query/shortest.h"
#include "server/query/pair_search.h"
#include "server/http/reply.h"
#include "server/query/api.h"

/* What most pictures take. */
#define BYTES_A_FACE    100
#define BYTES_AN_EDGE   32 /* while an isoline is traced */
#define BYTES_A_PIXEL   32
#define BYTES_A_PICTURE ((size_t)8 << 20)

#define PATH_SHARE 0.3 /* of the work */
#define WHAT       "the picture"

typedef enum gd_status renderer(const struct gd_picture *picture, const struct gd_control *control,
                                void **bytes, size_t *size);

struct format {
    renderer *render;
    const char *media_type;
    const char *policy; /* Content-Security-Policy; NULL: as of data */
};

struct picture {
    struct server_field_query field; /* first */
    struct proto_picture wanted;
    struct proto_located_points stops;
    struct gd_pair_answer route;
    const struct format *format;
    void *file; /* when it is there */
    size_t size;
};

static void release(struct server_query *query)
{
    struct picture *picture = (struct picture *)query;
    free(picture->file);
    gd_pair_answer_free(&picture->route);
    proto_located_points_free(&picture->stops);
    proto_picture_free(&picture->wanted);
    server_field_query_release(query);
}

/* --- the path --------------------------------------------------------------------------------- */

static bool refuse_absence(struct proto_problem *problem)
{
    return proto_problem_refuse(
        problem, "to",
        "no path leads there: the points lie in different components of the mesh; leave out "
        "from and to, or name others");
}

/* Leg by leg. */
static bool find_route(struct picture *picture, const struct server_monitor *whole,
                       struct proto_problem *problem)
{
    uint32_t legs = picture->stops.count ? picture->stops.count - 1 : 0;
    for (uint32_t i = 0; i < legs; i++) {
        struct server_monitor part = server_monitor_portion(whole, (double)i / legs, 1.0 / legs);
        struct gd_pair_answer leg;
        enum gd_status status =
            server_shortest_path(&picture->field.query, &part, &picture->stops.points[i],
                                 &picture->stops.points[i + 1], GD_PAIR_PATH, &leg);
        if (!status) status = server_pair_append(&picture->route, &leg);
        if (status) {
            server_query_fail(&picture->field.query, status, "the search", problem);
            return false;
        }
    }
    return !isinf(picture->route.distance) || refuse_absence(problem);
}

/* --- the picture ------------------------------------------------------------------------------ */

static enum gd_status render(void *user, const struct gd_control *control, size_t *kept)
{
    struct picture *picture = user;
    enum gd_status status =
        picture->format->render(&picture->wanted.picture, control, &picture->file, &picture->size);
    if (!status) *kept = picture->size;
    return status;
}

static size_t grant_of(const struct gd_picture *picture)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(picture->mesh);
    return BYTES_A_PICTURE + (size_t)picture->width * picture->height * BYTES_A_PIXEL +
           (size_t)summary->faces * BYTES_A_FACE +
           (picture->field ? (size_t)summary->edges * BYTES_AN_EDGE : 0);
}

/* The file's bytes go with the exchange. */
static enum server_query_turn draw(struct picture *picture, const struct gd_field *field,
                                   struct server_monitor *part, struct proto_problem *problem)
{
    struct server_query *query = &picture->field.query;
    struct server_monitor first = server_monitor_portion(part, 0, PATH_SHARE),
                          second = server_monitor_portion(part, PATH_SHARE, 1 - PATH_SHARE);
    struct gd_picture *wanted = &picture->wanted.picture;
    if (!find_route(picture, &first, problem)) return SERVER_QUERY_FAILED;
    wanted->mesh = query->surface->mesh;
    wanted->field = field;
    wanted->path = picture->route.path.count ? &picture->route.path : NULL;
    const struct server_budgeted_call call = {.make = render,
                                              .user = picture,
                                              .control = server_exchange_control(&second),
                                              .grant = grant_of(wanted)};
    enum gd_status status = server_budgeted_call_run(query->exchange->host->workspaces, &call);
    if (status) return server_query_fail(query, status, WHAT, problem);
    query->exchange->held += picture->size;
    return SERVER_QUERY_DONE;
}

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    return draw((struct picture *)query, field, part, problem);
}

/* --- the steps -------------------------------------------------------------------------------- */

static bool has_field(const struct picture *picture)
{
    return picture->wanted.field || picture->wanted.has_source;
}

static bool find_field(struct picture *picture, struct proto_problem *problem)
{
    struct proto_set set;
    picture->field.answer = answer;
    if (picture->wanted.field)
        return server_field_query_of_id(&picture->field, picture->wanted.field, problem);
    return !picture->wanted.has_source ||
           (proto_set_of_point(&picture->wanted.source, &set, problem) &&
            server_field_query_of_set(&picture->field, &set, 0, problem));
}

static bool parse(struct server_query *query, const struct proto_parameters *parameters,
                  struct proto_problem *problem)
{
    struct picture *picture = (struct picture *)query;
    if (!proto_picture_parse(parameters, &picture->wanted, problem)) return false;
    if (picture->wanted.stops.count &&
        !proto_points_locate(query->surface->mesh, &picture->wanted.stops, &picture->stops,
                             problem))
        return false;
    return find_field(picture, problem);
}

static enum server_query_turn glance(struct server_query *query, struct proto_problem *problem)
{
    return has_field((struct picture *)query) ? server_field_query_glance(query, problem)
                                              : SERVER_QUERY_AGAIN;
}

static bool join(struct server_query *query)
{
    return has_field((struct picture *)query) && server_field_query_join(query);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct picture *picture = (struct picture *)query;
    struct server_monitor whole = server_query_monitor(query, 0, 1);
    if (has_field(picture)) return server_field_query_solve(query, problem);
    return draw(picture, NULL, &whole, problem);
}

/* --- the two formats -------------------------------------------------------------------------- */

/* An SVG that is opened as a page may show the image that it embeds, and nothing else. */
static const struct format png = {gd_picture_png, "image/png", NULL},
                           svg = {gd_picture_svg, "image/svg+xml",
                                  "default-src 'none'; img-src data:; sandbox"};

/* Hands the file over. */
static void reply(struct server_query *query)
{
    struct picture *picture = (struct picture *)query;
    void *file = picture->file;
    picture->file = NULL;
    query->exchange->response.policy = picture->format->policy;
    server_reply_bytes(query->exchange, 200, picture->format->media_type, file, picture->size);
}

static bool parse_png(struct server_query *query, const struct proto_parameters *parameters,
                      struct proto_problem *problem)
{
    ((struct picture *)query)->format = &png;
    return parse(query, parameters, problem);
}

static bool parse_svg(struct server_query *query, const struct proto_parameters *parameters,
                      struct proto_problem *problem)
{
    ((struct picture *)query)->format = &svg;
    return parse(query, parameters, problem);
}

#define PICTURE_STEPS                                                                              \
    .size = sizeof(struct picture), .parameters = proto_picture_parameters, .glance = glance,      \
    .join = join, .solve = solve, .reply = reply, .release = release

static const struct server_query_kind png_kind = {.name = "picture.png",
                                                  .parse = parse_png,
                                                  PICTURE_STEPS},
                                      svg_kind = {
                                          .name = "picture.svg", .parse = parse_svg, PICTURE_STEPS};

static void handle(struct server_exchange *exchange, const struct server_query_kind *kind,
                   const struct format *format)
{
    if (proto_accept_quality(server_exchange_header(exchange, "Accept"), format->media_type))
        server_query_handle(exchange, kind);
    else
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "the answer is %s, which Accept excludes", format->media_type);
}

void server_handle_picture_png(struct server_exchange *exchange)
{
    handle(exchange, &png_kind, &png);
}

void server_handle_picture_svg(struct server_exchange *exchange)
{
    handle(exchange, &svg_kind, &svg);
}
