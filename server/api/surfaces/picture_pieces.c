#include "server/api/surfaces/picture_layers.h"

#include <math.h>
#include <string.h>

#include "gd/curve.h"
#include "server/work/executor.h"

/* A piece faces the direction of the sum of its faces' area vectors. If the sum is shorter than
 * this fraction of the piece's area, the piece faces no direction; for example, it is closed or a
 * tube. */
#define FLAT_LEAST 0.1

struct piece {
    struct gd_vec3 low, high; /* bounding box */
    struct gd_vec3 facing;    /* sum of the area vectors */
    double area;
};

struct pieces {
    struct gd_polygons polygons;        /* polygons of all pieces, piece after piece */
    const uint32_t *vertices, *corners; /* index where each piece begins, and the total number */
    uint32_t count;
};

static struct gd_vec3 position_at(const struct pieces *pieces, uint32_t vertex)
{
    const double *xyz = pieces->polygons.positions[vertex];
    return (struct gd_vec3){xyz[0], xyz[1], xyz[2]};
}

static struct piece piece_measure(const struct pieces *pieces, uint32_t i)
{
    struct piece piece = {.low = {INFINITY, INFINITY, INFINITY},
                          .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t v = pieces->vertices[i]; v < pieces->vertices[i + 1]; v++) {
        struct gd_vec3 p = position_at(pieces, v);
        piece.low = (struct gd_vec3){fmin(piece.low.x, p.x), fmin(piece.low.y, p.y),
                                     fmin(piece.low.z, p.z)};
        piece.high = (struct gd_vec3){fmax(piece.high.x, p.x), fmax(piece.high.y, p.y),
                                      fmax(piece.high.z, p.z)};
    }
    for (uint32_t c = pieces->corners[i]; c < pieces->corners[i + 1]; c += 3) {
        const uint32_t *corner = pieces->polygons.corners + c;
        struct gd_vec3 a = position_at(pieces, corner[0]),
                       ab = gd_vec3_sub(position_at(pieces, corner[1]), a),
                       ac = gd_vec3_sub(position_at(pieces, corner[2]), a),
                       vector = gd_vec3_scale(gd_vec3_cross(ab, ac), 0.5);
        piece.facing = gd_vec3_add(piece.facing, vector);
        piece.area += gd_vec3_length(vector);
    }
    return piece;
}

static struct gd_vec3 piece_middle(const struct piece *piece)
{
    return gd_vec3_scale(gd_vec3_add(piece->low, piece->high), 0.5);
}

/* Moves piece i by `distance` in the direction that it faces. A piece that faces no direction is
 * moved away from the middle of the largest piece. */
static void piece_move(const struct pieces *pieces, uint32_t i, struct gd_vec3 middle,
                       double distance)
{
    struct piece piece = piece_measure(pieces, i);
    struct gd_vec3 way = piece.facing;
    if (gd_vec3_length(way) < FLAT_LEAST * piece.area)
        way = gd_vec3_sub(piece_middle(&piece), middle);
    double length = gd_vec3_length(way);
    if (length == 0) return;
    for (uint32_t v = pieces->vertices[i]; v < pieces->vertices[i + 1]; v++) {
        struct gd_vec3 moved = gd_vec3_along(position_at(pieces, v), distance / length, way);
        memcpy(pieces->polygons.positions[v], (const double[]){moved.x, moved.y, moved.z},
               sizeof(double[3]));
    }
}

/* Moves all pieces except the largest one. */
static void pieces_move(const struct pieces *pieces, double distance)
{
    struct gd_vec3 middle = {0};
    double largest = -1;
    uint32_t stays = 0;
    for (uint32_t i = 0; i < pieces->count; i++) {
        struct piece piece = piece_measure(pieces, i);
        if (piece.area <= largest) continue;
        largest = piece.area;
        stays = i;
        middle = piece_middle(&piece);
    }
    for (uint32_t i = 0; i < pieces->count; i++)
        if (i != stays) piece_move(pieces, i, middle, distance);
}

/* Copies the pieces from the answer. */
static bool pieces_take(struct server_query *query, const struct server_arrays *arrays,
                        struct pieces *out)
{
    const struct server_array *positions = server_arrays_find(arrays, "positions"),
                              *corners = server_arrays_find(arrays, "corners"),
                              *vertices = server_arrays_find(arrays, "piece_vertices");
    size_t bytes = positions->rows * sizeof *out->polygons.positions;
    out->polygons.positions = server_query_allocate(query, positions->rows, sizeof(double[3]));
    if (!out->polygons.positions) return server_query_refuse(query, GD_BUDGET, "the figure");
    memcpy(out->polygons.positions, positions->source, bytes);
    out->polygons.position_count = (uint32_t)positions->rows;
    out->polygons.polygon_count = (uint32_t)corners->rows;
    out->polygons.corners = (uint32_t *)corners->source;
    out->vertices = vertices->source;
    out->corners = server_arrays_find(arrays, "piece_corners")->source;
    out->count = (uint32_t)vertices->rows - 1;
    return true;
}

static bool mesh_build(struct server_picture_surface *surface, struct server_query *query,
                       const struct gd_polygons *polygons)
{
    struct gd_detail detail = {0};
    struct server_budgeted_call call = server_query_begin_call(
        query, NULL, gd_mesh_build_cost(polygons->polygon_count, polygons->position_count));
    call.control.executor = server_executor_start_for(
        query->exchange->host->workers, polygons->polygon_count, query->exchange->job.deadline_ns);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_mesh_build(polygons, NULL, &call.control, &surface->pieces, &detail);
        if (!call.status) call.kept = gd_mesh_memsize(surface->pieces);
    }
    server_executor_stop(call.control.executor);
    return !call.status || server_query_refuse(query, call.status, "the pieces");
}

/* Adds the boundary loops of the mesh as closed lines. */
static bool boundaries_draw(struct server_picture_layers *layers, struct server_query *query,
                            uint32_t i)
{
    const struct gd_mesh *mesh = layers->surface->pieces;
    uint32_t count = gd_mesh_summary(mesh)->boundaries;
    uint64_t total = 0;
    for (uint32_t k = 0; k < count; k++) total += gd_mesh_boundary(mesh, k).vertices + UINT64_C(1);
    struct gd_picture_layer *drawn = server_drawn_add(layers, i);
    uint32_t *first = server_drawn_reserve(layers, query, count, total, drawn);
    if (!first) return false;
    struct gd_vec3 *points = (struct gd_vec3 *)drawn->points;
    for (uint32_t k = 0; k < count; k++) {
        const struct gd_curve_request request = {.kind = GD_CURVE_BOUNDARY, .boundary = k};
        struct gd_curve curve;
        enum gd_status status = gd_curve_resolve(mesh, &request, NULL, &curve, NULL);
        if (status) return server_query_refuse(query, status, "the pieces");
        for (uint32_t p = 0; p <= curve.count; p++)
            *points++ = gd_point_position(mesh, &curve.points[p % curve.count]);
        gd_curve_free(&curve);
        first[k + 1] = (uint32_t)(points - drawn->points);
    }
    return true;
}

bool server_pieces_draw(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, const struct server_arrays *arrays)
{
    const struct gd_mesh_summary *whole = gd_mesh_summary(query->surface->mesh);
    double diagonal = gd_vec3_length(gd_vec3_sub(whole->max, whole->min));
    struct pieces pieces = {0};
    if (!pieces_take(query, arrays, &pieces)) return false;
    pieces_move(&pieces, layers->wanted->items[i].apart * diagonal);
    return mesh_build(layers->surface, query, &pieces.polygons) &&
           boundaries_draw(layers, query, i);
}
