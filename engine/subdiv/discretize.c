#include "gd/discretization.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "subdiv/grid.h"
#include "subdiv/tiling.h"

enum { FACES_MOST = 1 << 28, BYTES_PER_VERTEX = 96 };

/* --- levels by a tolerance -------------------------------------------------------------------- */

enum { FINER = 2, STEP = 1 << FINER };

static void grid_room_free(struct gd__grid_room *room)
{
    free(room->positions);
    free(room->normals);
    *room = (struct gd__grid_room){0};
}

/* Allocates the arrays of a grid of `level`; grid_room_free frees them. The caller holds `held`
 * bytes. Errors: GD_NO_MEMORY, GD_BUDGET. */
static enum gd_status grid_room_create(uint32_t level, const struct gd_control *control,
                                       size_t held, struct gd__grid_room *out)
{
    size_t side = ((size_t)1 << level) + 1;
    enum gd_status status =
        gd_control_afford(control, held + side * side * 2 * sizeof(struct gd_vec3));
    if (status) return status;
    struct gd__grid_room room = {gd__large_array(side * side, sizeof *room.positions),
                                 gd__large_array(side * side, sizeof *room.normals)};
    if (!room.positions || !room.normals) {
        grid_room_free(&room);
        return GD_NO_MEMORY;
    }
    *out = room;
    return GD_OK;
}

/* The fine grid of a face; `side` is the number of vertices in a row. */
struct fine {
    const struct gd_vec3 *positions, *normals;
    uint32_t cells, side;
    bool triangles;
};

static struct gd_vec3 point(const struct fine *fine, uint32_t i, uint32_t j)
{
    return fine->positions[i * fine->side + j];
}

/* Returns a + x (b - a) + y (c - a). */
static struct gd_vec3 on_triangle(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c, double x,
                                  double y)
{
    return gd_vec3_along(gd_vec3_along(a, x, gd_vec3_sub(b, a)), y, gd_vec3_sub(c, a));
}

/* Returns the distance of the fine vertex (i,j), along its normal, from the triangles of its coarse
 * cell. A quad cell can be divided along either diagonal; returns the greater of the two
 * distances. */
static double off_triangles(const struct fine *fine, uint32_t i, uint32_t j)
{
    uint32_t i0 = i / STEP * STEP, j0 = j / STEP * STEP;
    double x = (double)(i - i0) / STEP, y = (double)(j - j0) / STEP;
    struct gd_vec3 p = point(fine, i, j), normal = fine->normals[i * fine->side + j];
    struct gd_vec3 b = point(fine, i0 + STEP, j0), d = point(fine, i0, j0 + STEP),
                   a = point(fine, i0, j0);
    struct gd_vec3 flat = x + y <= 1
                              ? on_triangle(a, b, d, x, y)
                              : on_triangle(point(fine, i0 + STEP, j0 + STEP), d, b, 1 - x, 1 - y);
    double off = fabs(gd_vec3_dot(gd_vec3_sub(p, flat), normal));
    if (fine->triangles) return off;
    struct gd_vec3 c = point(fine, i0 + STEP, j0 + STEP);
    flat = x >= y ? on_triangle(b, a, c, 1 - x, y) : on_triangle(d, c, a, x, 1 - y);
    return fmax(off, fabs(gd_vec3_dot(gd_vec3_sub(p, flat), normal)));
}

static double off_inside(const struct fine *fine, struct gd__pace *pace)
{
    double most = 0;
    for (uint32_t i = 0; i < fine->cells && gd__pace(pace, fine->cells); i++) {
        uint32_t end = fine->triangles ? fine->cells - i : fine->cells;
        for (uint32_t j = 0; j < end; j++) most = fmax(most, off_triangles(fine, i, j));
    }
    return most;
}

static double off_chord(struct gd_vec3 p, struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 chord = gd_vec3_sub(b, a), way = gd_vec3_sub(p, a);
    double square = gd_vec3_dot(chord, chord);
    if (!(square > 0)) return gd_vec3_length(way);
    return gd_vec3_length(gd_vec3_along(way, -gd_vec3_dot(way, chord) / square, chord));
}

static struct gd_vec3 on_side(const struct fine *fine, uint32_t k, uint32_t m)
{
    uint32_t at[2];
    gd__side_place(fine->triangles ? 3 : 4, k, fine->cells, m, at);
    return point(fine, at[0], at[1]);
}

static double off_sides(const struct fine *fine)
{
    double most = 0;
    for (uint32_t k = 0; k < (fine->triangles ? 3 : 4); k++) {
        for (uint32_t m = 0; m < fine->cells; m++) {
            uint32_t begin = m / STEP * STEP;
            double off = off_chord(on_side(fine, k, m), on_side(fine, k, begin),
                                   on_side(fine, k, begin + STEP));
            most = fmax(most, off);
        }
    }
    return most;
}

/* LEVEL_LIMIT: the finest level that can be measured. DOUBTFUL_LEVELS: the error of a smooth
 * surface decreases by 4 for each level, but between coarse levels it may decrease faster. So a
 * face may need this many levels fewer than its error suggests. */
enum { LEVEL_LIMIT = GD__LEVEL_MOST - FINER, DOUBTFUL_LEVELS = 2 };

/* Returns a lower bound of the level that a face needs if the error of `level` is `off`. */
static uint32_t least_level(uint32_t level, double off, double tolerance)
{
    double more = ceil(log2(off / tolerance) / 2) - DOUBTFUL_LEVELS;
    return level + (uint32_t)fmin(fmax(more, 1), LEVEL_LIMIT);
}

struct search {
    struct gd__walker walker;  /* has enough stages for the finest grid */
    struct gd__grid_room room; /* for the grids of the current level */
    double tolerance;
    uint64_t most, settled; /* limit on the triangles, and triangles of the faces that are done */
    struct gd__pace pace;
};

/* Computes the error of `level` in one face. */
static enum gd_status error_at(struct search *search, uint32_t face, uint32_t level, double *out)
{
    uint32_t cells = STEP << level;
    enum gd_status status =
        gd__grid(&search->walker, face, level + FINER, &search->room, &search->pace);
    if (status) return status;
    struct fine fine = {search->room.positions, search->room.normals, cells, cells + 1,
                        search->walker.surface->rules->arity == 3};
    *out = fmax(off_inside(&fine, &search->pace), off_sides(&fine));
    return search->pace.status;
}

/* Measures the faces whose level in the tiling is `level`. Increments the level of those that need
 * a finer one, and sets *open to true if there are any. Error: GD_TOO_LARGE (a face needs more than
 * LEVEL_LIMIT levels, or all faces need more than `most` triangles). */
static enum gd_status measure_level(struct search *search, uint32_t level,
                                    struct gd__tiling *tiling, bool *open)
{
    const struct gd_subdivision *surface = tiling->surface;
    uint32_t faces = surface->base.face_count;
    uint64_t expected = 0;
    *open = false;
    for (uint32_t face = 0; face < faces; face++) {
        double off;
        if (tiling->face_level[face] != level) continue;
        enum gd_status status = error_at(search, face, level, &off);
        if (status) return status;
        bool is_done = off <= search->tolerance;
        uint32_t least = is_done ? level : least_level(level, off, search->tolerance);
        *(is_done ? &search->settled : &expected) +=
            gd__face_triangles(surface, UINT64_C(1) << least);
        if (least > LEVEL_LIMIT || search->settled + expected > search->most) return GD_TOO_LARGE;
        tiling->face_level[face] += !is_done;
        *open = *open || !is_done;
    }
    return GD_OK;
}

/* Sets the level of each face of a tiling to the coarsest level that satisfies `tolerance`. The
 * error of a level is measured at the vertices of the grid that is two levels finer. For a vertex
 * inside the face, the error is the distance from the triangles along the normal. For a vertex on a
 * side, it is the distance from the chord of the coarse edge. All faces are measured at one level
 * before any face is measured at the next one, so a tolerance that needs too many triangles is
 * refused after little work. Errors: those of measure_level, GD_NO_MEMORY, GD_BUDGET. */
static enum gd_status chordal_levels(struct gd__tiling *tiling, double tolerance, uint64_t most,
                                     const struct gd_control *control)
{
    const struct gd_subdivision *surface = tiling->surface;
    /* a face with finer edges must have an inner vertex */
    uint32_t least = surface->rules->arity == 4 ? 1 : 2;
    struct search search = {.tolerance = tolerance, .most = most, .pace = {.control = control}};
    enum gd_status status =
        gd__walker_create(&search.walker, surface, gd__grid_stages(GD__LEVEL_MOST), control);
    size_t held = tiling->arena.budget.held + search.walker.arena.budget.held;
    bool open = true;
    memset(tiling->face_level, (int)least, surface->base.face_count);
    for (uint32_t level = least; !status && open; level++) {
        search.pace.fraction = 0.5 - ldexp(0.5, (int)least - (int)level);
        status = gd_control_check(control, search.pace.fraction);
        if (!status) status = grid_room_create(level + FINER, control, held, &search.room);
        if (!status) status = measure_level(&search, level, tiling, &open);
        grid_room_free(&search.room);
    }
    gd__walker_free(&search.walker);
    return status;
}

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
    bool has_tolerance = options->tolerance > 0;
    enum gd_status status = gd__tiling_create(surface, level, out);
    if (!status && has_tolerance) status = chordal_levels(out, options->tolerance, most, control);
    if (!status) status = gd__tiling_number(out, most);
    if (status != GD_TOO_LARGE) return status;
    if (has_tolerance)
        return gd_fail(detail, status,
                       "a tolerance of %g needs more than %u triangles or more than %d halvings: "
                       "choose a larger one",
                       options->tolerance, most, LEVEL_LIMIT);
    return gd_fail(
        detail, status,
        "that would be %llu triangles, and at most %u are allowed: choose a coarser level",
        (unsigned long long)out->triangles, most);
}

static size_t discretization_bytes(size_t vertices, size_t corners)
{
    return vertices * BYTES_PER_VERTEX + corners * sizeof(uint32_t);
}

static enum gd_status discretize_create(const struct gd__tiling *tiling,
                                        const struct gd_control *control,
                                        struct gd_discretization *out)
{
    size_t vertices = tiling->vertices, corners = 3 * tiling->triangles;
    enum gd_status status = gd_control_afford(control, discretization_bytes(vertices, corners));
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
    size_t held = tiling->arena.budget.held + walker.arena.budget.held +
                  discretization_bytes(tiling->vertices, 3 * tiling->triangles);
    if (!status) status = grid_room_create(most, control, held, &room);
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
    grid_room_free(&room);
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
    if (!status) status = discretize_create(&tiling, control, &made);
    if (!status) status = place_vertices(&tiling, control, &made);
    if (!status) status = tile(&tiling, control, &made);
    gd__arena_free(&tiling.arena);
    if (status)
        gd_discretization_free(&made);
    else
        *out = made;
    return status;
}
