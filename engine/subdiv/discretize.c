#include "gd/discretization.h"

#include <math.h>
#include <stdlib.h>

#include "base/large.h"
#include "subdiv/chordal.h"

enum { FACES_MOST = 1 << 28, BYTES_PER_VERTEX = 96 };

void gd_discretization_free(struct gd_discretization *discretization)
{
    if (!discretization) return;
    gd_polygons_free(&discretization->polygons);
    free(discretization->places);
    free(discretization->normals);
    *discretization = (struct gd_discretization){0};
}

static enum gd_status check_options(const struct gd_subdivision *surface,
                                    const struct gd_discretize_options *options,
                                    struct gd_detail *detail)
{
    if (options->tolerance != 0 && !(options->tolerance > 0 && options->tolerance < INFINITY))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the tolerance is %g: it must be a length above 0", options->tolerance);
    if (options->level > GD__LEVEL_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the level is %u: at most %d is taken",
                       options->level, GD__LEVEL_MOST);
    if (options->tolerance == 0 && options->level == 0 && surface->split_first)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the level is 0, but the control mesh has faces that are not quads: use "
                       "level 1 or more");
    return GD_OK;
}

/* Chooses the levels, and numbers the vertices. */
static enum gd_status plan(const struct gd_subdivision *surface,
                           const struct gd_discretize_options *options,
                           const struct gd_control *control, struct gd__tiling *out,
                           struct gd_detail *detail)
{
    uint32_t most =
        options->max_faces && options->max_faces < FACES_MOST ? options->max_faces : FACES_MOST;
    uint32_t level = options->level - (surface->split_first && options->level > 0);
    enum gd_status status = gd__tiling_create(surface, level, out);
    if (status) return status;
    if (options->tolerance > 0)
        status = gd__chordal_levels(surface, options->tolerance, control, out);
    if (status == GD_TOO_LARGE)
        gd_fail(detail, status,
                "a tolerance of %g asks for more than %d halvings: choose a larger one",
                options->tolerance, GD__LEVEL_MOST - 2);
    if (!status) {
        status = gd__tiling_number(out, most);
        if (status)
            gd_fail(
                detail, status,
                "that would be %llu triangles, and at most %u are allowed: choose a coarser level",
                (unsigned long long)out->triangles, most);
    }
    if (status) gd__tiling_free(out);
    return status;
}

static enum gd_status discretize_create(const struct gd__tiling *tiling,
                                        const struct gd_control *control,
                                        struct gd_discretization *out)
{
    size_t vertices = tiling->vertices, corners = 3 * tiling->triangles;
    enum gd_status status =
        gd_control_afford(control, vertices * BYTES_PER_VERTEX + corners * sizeof(uint32_t));
    if (status) return status;
    struct gd_discretization made = {.polygons = {.position_count = (uint32_t)vertices,
                                                  .polygon_count = (uint32_t)tiling->triangles}};
    made.polygons.positions = gd__large_array(vertices, sizeof *made.polygons.positions);
    made.polygons.corners = gd__large_array(corners, sizeof *made.polygons.corners);
    made.places = gd__large_array(vertices, sizeof *made.places);
    made.normals = gd__large_array(vertices, sizeof *made.normals);
    if (!made.polygons.positions || !made.polygons.corners || !made.places || !made.normals) {
        gd_discretization_free(&made);
        return GD_NO_MEMORY;
    }
    *out = made;
    return GD_OK;
}

/* A grid over a base face with `cells` cells along a side. The vertices of the face are copied from
 * this grid. */
struct source {
    const struct gd__tiling *tiling;
    const struct gd__grid_room *room;
    struct gd_discretization *out;
    uint32_t face, cells;
    uint32_t control_face, corner;
    struct gd__chart frame; /* chart of the base face in its control face */
    struct gd__pace *pace;
};

static void discretize_put(const struct source *source, uint32_t vertex, uint32_t i, uint32_t j)
{
    uint32_t at = i * (source->cells + 1) + j;
    struct gd_vec3 p = source->room->positions[at];
    double uv[2], *position = source->out->polygons.positions[vertex];
    position[0] = p.x, position[1] = p.y, position[2] = p.z;
    source->out->normals[vertex] = source->room->normals[at];
    gd__chart_out(&source->frame, (double)i / source->cells, (double)j / source->cells, uv);
    source->out->places[vertex] =
        (struct gd_limit_point){source->control_face, source->corner, uv[0], uv[1]};
}

/* Writes the base point where side k of the face begins. Of the two faces of an edge, the one whose
 * side has the lower number also writes the inner vertices of the edge. */
static void put_side(const struct source *source, uint32_t k)
{
    const struct gd__net *base = &source->tiling->surface->base;
    uint32_t side = base->arity * source->face + k, at[2];
    uint32_t edge_cells = 1u << source->tiling->edge_level[base->edge[side]],
             step = source->cells / edge_cells;
    uint32_t end = base->twin[side] > side ? edge_cells : 1;
    for (uint32_t m = 0; m < end; m++) {
        gd__side_place(base->arity, k, source->cells, m * step, at);
        discretize_put(source, gd__tiling_on_side(source->tiling, side, m), at[0], at[1]);
    }
}

static void put_face(const struct source *source)
{
    uint32_t arity = source->tiling->surface->rules->arity;
    uint32_t cells = 1u << source->tiling->face_level[source->face], step = source->cells / cells;
    for (uint32_t k = 0; k < arity; k++) put_side(source, k);
    for (uint32_t i = 1; i < cells && gd__pace(source->pace, cells); i++) {
        uint32_t end = arity == 3 ? cells - i : cells;
        uint32_t vertex =
            end > 1 ? gd__tiling_inside(source->tiling, source->face, cells, i, 1) : 0;
        for (uint32_t j = 1; j < end; j++) discretize_put(source, vertex++, i * step, j * step);
    }
}

static uint32_t finest(const struct gd__tiling *tiling)
{
    uint32_t level = 0;
    for (uint32_t edge = 0; edge < tiling->surface->base_edges; edge++)
        level = tiling->edge_level[edge] > level ? tiling->edge_level[edge] : level;
    return level;
}

static enum gd_status place_vertices(const struct gd__tiling *tiling,
                                     const struct gd_control *control,
                                     struct gd_discretization *out)
{
    const struct gd_subdivision *surface = tiling->surface;
    uint32_t most = finest(tiling), faces = surface->base.face_count;
    struct gd__walker walker = {0};
    struct gd__grid_room room = {0};
    enum gd_status status = gd__walker_create(&walker, surface, gd__grid_stages(most), control);
    if (!status) status = gd__grid_room(most, &room);
    struct gd__pace pace = {.control = control, .count = GD__PACE_STEPS};
    for (uint32_t face = 0; !status && face < faces; face++) {
        uint32_t level = gd__tiling_finest(tiling, face);
        pace.fraction = 0.5 + 0.4 * face / faces;
        (void)gd__pace(&pace, 64);
        status = gd__grid(&walker, face, level, &room, &pace);
        if (status) break;
        struct source source = {.tiling = tiling,
                                .room = &room,
                                .out = out,
                                .face = face,
                                .cells = 1u << level,
                                .pace = &pace};
        source.frame = gd__base_frame(surface, face, &source.control_face, &source.corner);
        put_face(&source);
        status = pace.status;
    }
    gd__grid_room_free(&room);
    gd__walker_free(&walker);
    return status;
}

static enum gd_status tile(const struct gd__tiling *tiling, const struct gd_control *control,
                           struct gd_discretization *out)
{
    uint32_t faces = tiling->surface->base.face_count, *at = out->polygons.corners;
    struct gd__pace pace = {.control = control};
    for (uint32_t face = 0; !pace.status && face < faces; face++) {
        pace.fraction = 0.9 + 0.1 * face / faces;
        at = gd__tile(tiling, face, (const double(*)[3])out->polygons.positions, at, &pace);
    }
    return pace.status;
}

enum gd_status gd_discretize(const struct gd_subdivision *surface,
                             const struct gd_discretize_options *options,
                             const struct gd_control *control, struct gd_discretization *out,
                             struct gd_detail *detail)
{
    struct gd_discretize_options coarse = {0};
    if (!options) options = &coarse;
    struct gd__tiling tiling = {0};
    struct gd_discretization made = {0};
    enum gd_status status = check_options(surface, options, detail);
    if (!status) status = plan(surface, options, control, &tiling, detail);
    if (status) return status;
    status = discretize_create(&tiling, control, &made);
    if (!status) status = place_vertices(&tiling, control, &made);
    if (!status) status = tile(&tiling, control, &made);
    gd__tiling_free(&tiling);
    if (status)
        gd_discretization_free(&made);
    else
        *out = made;
    return status;
}
