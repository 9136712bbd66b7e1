#include "server/api/surfaces/picture_surface.h"

#include "server/query/api.h"
#include "server/surfaces/kinds.h"

#define MESH_PART 0.3 /* fraction of the work for the mesh; the rest is for the field */

#define NURBS_BYTES          ((size_t)8 << 20)
#define NURBS_FACES          40000 /* enough for smooth outlines */
#define BYTES_PER_NURBS_FACE 400

static bool is_subdivision(const struct server_query *query)
{
    return query->surface->record->kind == &server_kind_subdivision;
}

bool server_picture_surface_decode(struct server_picture_surface *surface,
                                   struct server_query *query, const json_t *body)
{
    return is_subdivision(query)
               ? proto_picture_limit_places_decode(body,
                                                   server_subdivision_of(query->surface)->surface,
                                                   &surface->places, query->problem)
               : proto_picture_places_decode(body, server_nurbs_of(query->surface)->surface,
                                             &surface->uvs, query->problem);
}

void server_picture_surface_close(struct server_picture_surface *surface)
{
    gd_field_release(surface->field);
    gd_mesh_release(surface->pieces);
    server_discretization_release(surface->discretization);
    gd_tessellation_release(surface->tessellation);
    proto_uvs_free(&surface->uvs);
    proto_limit_places_free(&surface->places);
}

/* --- the mesh --------------------------------------------------------------------------------- */

static enum gd_status subdivision_mesh(struct server_picture_surface *surface,
                                       struct server_query *query, double share,
                                       struct gd_detail *detail)
{
    struct server_subdivision *subdivision = server_subdivision_of(query->surface);
    struct server_monitor monitor = server_query_monitor(query, 0, share);
    const struct server_discretization_request request = {
        .slot = &subdivision->slot,
        .surface = subdivision->surface,
        .level = gd_limit_mesh_usual_level(subdivision->surface),
        .control = server_exchange_control(&monitor),
        .detail = detail};
    enum gd_status status = server_discretizations_get(query->exchange->host->api->discretizations,
                                                       &request, &surface->discretization);
    if (!status) surface->mesh = gd_limit_mesh_mesh(surface->discretization->mesh);
    return status;
}

static enum gd_status nurbs_mesh(struct server_picture_surface *surface, struct server_query *query,
                                 double share, struct gd_detail *detail)
{
    struct server_monitor monitor = server_query_monitor(query, 0, share);
    struct server_budgeted_call call = server_query_begin_call(
        query, &monitor, NURBS_BYTES + (size_t)NURBS_FACES * BYTES_PER_NURBS_FACE);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_tessellation_build(server_nurbs_of(query->surface)->surface,
                                            &(struct gd_tessellation_options){.faces = NURBS_FACES},
                                            &call.control, &surface->tessellation, detail);
        if (!call.status) call.kept = gd_tessellation_memsize(surface->tessellation);
    }
    if (!call.status) surface->mesh = gd_tessellation_mesh(surface->tessellation);
    return call.status;
}

static enum gd_status mesh_find(struct server_picture_surface *surface, struct server_query *query,
                                double share, struct gd_detail *detail)
{
    if (is_subdivision(query)) return subdivision_mesh(surface, query, share, detail);
    if (query->surface->record->kind == &server_kind_nurbs)
        return nurbs_mesh(surface, query, share, detail);
    surface->mesh = surface->pieces ? surface->pieces : query->surface->mesh;
    return GD_OK;
}

/* --- the field -------------------------------------------------------------------------------- */

static enum gd_status seed_place(const struct server_picture_surface *surface, uint32_t i,
                                 struct gd_seed *out, struct gd_detail *detail)
{
    if (surface->tessellation)
        return gd_tessellation_point(surface->tessellation, surface->uvs.items[i][0],
                                     surface->uvs.items[i][1], &out->point, detail);
    return gd_limit_mesh_point(surface->discretization->mesh, &surface->places.items[i],
                               &out->point, detail);
}

static enum gd_status field_build(struct server_picture_surface *surface,
                                  struct server_query *query, struct server_monitor monitor,
                                  struct gd_detail *detail)
{
    uint32_t count = surface->uvs.count + surface->places.count;
    struct gd_seed *seeds = count ? server_query_allocate(query, count, sizeof *seeds) : NULL;
    enum gd_status status = seeds || !count ? GD_OK : GD_BUDGET;
    for (uint32_t i = 0; i < count && !status; i++)
        status = seed_place(surface, i, &seeds[i], detail);
    if (status || !count) return status;
    const struct gd_field_request request = {
        .seeds = seeds, .seed_count = count, .radius = surface->max_distance};
    struct server_budgeted_call call =
        server_query_begin_call(query, &monitor, server_field_build_grant(surface->mesh));
    while (server_budgeted_call_next(&call)) {
        call.status =
            gd_field_build(surface->mesh, &request, &call.control, &surface->field, detail);
        if (!call.status) call.kept = gd_field_memsize(surface->field);
    }
    return call.status;
}

bool server_picture_surface_open(struct server_picture_surface *surface, struct server_query *query,
                                 double share)
{
    struct gd_detail detail = {0};
    enum gd_status status = GD_OK;
    if (surface->mesh) return true;
    status = mesh_find(surface, query, MESH_PART * share, &detail);
    if (!status)
        status = field_build(
            surface, query, server_query_monitor(query, MESH_PART * share, (1 - MESH_PART) * share),
            &detail);
    if (!status) return true;
    if (status == GD_BUDGET || !detail.text[0])
        return server_query_refuse(query, status, "the mesh of the figure");
    server_metrics_count_status(query->exchange->host->metrics, status);
    return proto_problem_from_status(query->problem, status, &detail);
}
