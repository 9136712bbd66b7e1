/* GET …/preview: replies with a simplified mesh as a file, or with the progress of making it. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "gd/edit.h"
#include "gd/io.h"
#include "proto/http/accept.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/surfaces/previews.h"

struct preview_request {
    struct server_surface *surface; /* borrowed from the exchange */
    /* NULL means that the mesh is small and needs no simplification */
    struct server_preview *preview;
    uint32_t faces;
    enum gd_format format;
};

static void request_free(void *state)
{
    struct preview_request *request = state;
    server_preview_release(request->preview);
    free(request);
}

/* Chooses the format by Accept; in a tie, GLB. */
static bool negotiate(const char *accept, enum gd_format *out, struct proto_problem *problem)
{
    unsigned glb = proto_accept_quality(accept, gd_format_media_type(GD_FORMAT_GLB));
    unsigned ply = proto_accept_quality(accept, gd_format_media_type(GD_FORMAT_PLY));
    *out = ply > glb ? GD_FORMAT_PLY : GD_FORMAT_GLB;
    return glb || ply ||
           proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "a preview is model/gltf-binary or application/x-ply");
}

static bool parameters_read(struct server_exchange *exchange, struct preview_request *out,
                            struct proto_problem *problem)
{
    uint64_t faces = SERVER_PREVIEW_FACES;
    unsigned format = 0;
    if (!proto_parameters_check(&exchange->parameters, proto_get_preview_parameters, problem) ||
        !proto_parameters_integer(&exchange->parameters, "faces", 1000, 1000000, &faces, problem) ||
        !proto_parameters_choice(&exchange->parameters, "format", proto_preview_format_words,
                                 &format, problem))
        return false;
    out->faces = (uint32_t)faces;
    out->format = gd_format_by_name(proto_preview_format_words[format]);
    return proto_parameters_get(&exchange->parameters, "format") ||
           negotiate(server_exchange_header(exchange, "Accept"), &out->format, problem);
}

/* --- the file --------------------------------------------------------------------------------- */

/* Returns an upper bound of the bytes of polygons and file. */
static size_t file_cost(const struct gd_mesh *mesh, const struct server_preview *preview)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    size_t faces = preview ? preview->polygons.polygon_count : summary->faces;
    size_t vertices = preview ? preview->polygons.position_count : summary->index_count;
    return vertices * 2 * sizeof(double[3]) + faces * 2 * sizeof(uint32_t[4]) + 4096;
}

static enum gd_status file_write(const struct preview_request *request, char **bytes, size_t *size,
                                 uint32_t *faces)
{
    struct gd_polygons polygons = {0};
    enum gd_status status = GD_OK;
    if (request->preview)
        polygons = request->preview->polygons;
    else
        status = gd_mesh_polygons(request->surface->mesh, &polygons);
    if (status) return status;
    *faces = polygons.polygon_count;
    status = gd_write_polygons(&polygons, request->format, bytes, size);
    if (!request->preview) gd_polygons_free(&polygons);
    return status;
}

static void file_reply(struct server_exchange *exchange, const struct preview_request *request,
                       char *bytes, size_t size, uint32_t faces)
{
    const struct server_record *record = request->surface->record;
    const char *name = gd_format_name(request->format);
    char form[64];
    snprintf(form, sizeof form, "preview-%u-%s", request->faces, name);
    server_reply_tag(exchange, record->etag, form);
    server_reply_header(exchange, "Vary", "Accept");
    server_reply_header(exchange, "Geodesic-Faces", "%u", faces);
    server_reply_header(exchange, "Geodesic-Largest-Distance", "%.17g",
                        request->preview ? request->preview->largest_distance : 0);
    server_reply_header(exchange, "Content-Disposition", "attachment; filename=\"%s-preview.%s\"",
                        record->name, name);
    server_reply_bytes(exchange, 200, gd_format_media_type(request->format), bytes, size);
}

/* Sends the file; runs on a worker. */
static bool file_send(struct server_exchange *exchange)
{
    const struct preview_request *request = exchange->state;
    size_t cost = file_cost(request->surface->mesh, request->preview), size;
    struct proto_problem problem;
    uint32_t faces = 0;
    char *bytes;
    bool is_taken = server_request_take(exchange, "the preview", cost, &problem);
    if (!server_reply_check(exchange, is_taken, &problem)) return true;
    enum gd_status status = file_write(request, &bytes, &size, &faces);
    bool is_written = server_request_check_file(status, &problem);
    if (!server_reply_check(exchange, is_written, &problem)) return true;
    server_budget_adjust(exchange->host->budget, SERVER_BUDGET_FLIGHT, cost, size);
    exchange->held = size;
    file_reply(exchange, request, bytes, size, faces);
    return true;
}

/* --- the request ------------------------------------------------------------------------------ */

static void progress_reply(struct server_exchange *exchange, double progress)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    proto_write_object_begin(&writer);
    proto_member_number(&writer, "progress", progress);
    proto_write_object_end(&writer);
    server_reply_header(exchange, "Retry-After", "1");
    server_reply_json(exchange, 202, &writer);
}

/* Finds the preview. Returns false after replying with a problem or with the progress. */
static bool find(struct server_exchange *exchange, struct preview_request *request)
{
    struct server_background *previews = exchange->host->api->previews;
    struct proto_problem problem;
    double progress = 0;
    if (gd_mesh_summary(request->surface->mesh)->faces <= request->faces) return true;
    enum gd_status status = server_previews_find(previews, request->surface, request->faces,
                                                 &request->preview, &progress);
    if (status == GD_BUDGET)
        server_budget_refuse(exchange->host->budget, "the preview",
                             gd_edit_cost(gd_mesh_summary(request->surface->mesh)->faces),
                             &problem);
    else if (status)
        proto_problem_from_status(&problem, status, NULL);
    if (!server_reply_check(exchange, !status, &problem)) return false;
    if (!request->preview) progress_reply(exchange, progress);
    return request->preview != NULL;
}

void server_handle_get_preview(struct server_exchange *exchange)
{
    struct preview_request wanted = {0};
    struct proto_problem problem;
    if (!server_reply_check(exchange, parameters_read(exchange, &wanted, &problem), &problem))
        return;
    wanted.surface = server_request_surface(exchange);
    if (!wanted.surface) return;
    struct preview_request *request =
        server_request_allocate(exchange, sizeof *request, request_free);
    if (!request) return;
    *request = wanted;
    if (find(exchange, request)) server_exchange_defer(exchange, file_send, NULL);
}
