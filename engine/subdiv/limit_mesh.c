/* See gd/limit_mesh.h. Triangles are numbered as in tile.c, for faces that have the same level as
 * their neighbours. */
#include "gd/limit_mesh.h"

#include <stdlib.h>

#include "base/share.h"
#include "gd/discretization.h"
#include "subdiv/domain.h"
#include "subdiv/surface.h"

enum { USUAL_TRIANGLES = 1 << 17, BYTES_PER_VERTEX = 120 };

struct gd_limit_mesh {
    struct gd_subdivision *surface; /* one reference is owned */
    struct gd_mesh *mesh;
    struct gd_vec3 *normals;
    /* level given by the options, and number of cells along a side of a base face */
    uint32_t level, cells;
};

/* --- sizes ------------------------------------------------------------------------------------ */

static uint64_t triangles_at(const struct gd_subdivision *surface, uint32_t level)
{
    return surface->base.face_count * gd__face_triangles(surface, gd__level_cells(surface, level));
}

uint32_t gd_limit_mesh_least_level(const struct gd_subdivision *surface)
{
    return surface->split_first != NULL;
}

uint32_t gd_limit_mesh_usual_level(const struct gd_subdivision *surface)
{
    uint32_t level = gd_limit_mesh_least_level(surface);
    while (level < GD_LIMIT_LEVEL_MOST && triangles_at(surface, level + 1) <= USUAL_TRIANGLES)
        level++;
    return level;
}

/* Returns an upper bound on the number of vertices. A surface of T triangles has at most T / 2
 * inner vertices, its boundary vertices, and two more for each component. */
static uint64_t vertices_at(const struct gd_subdivision *surface, uint32_t level)
{
    return triangles_at(surface, level) / 2 + surface->base.point_count +
           (uint64_t)surface->base_edges * gd__level_cells(surface, level) / 2;
}

size_t gd_limit_mesh_cost(const struct gd_subdivision *surface, uint32_t level)
{
    uint64_t triangles = triangles_at(surface, level), vertices = vertices_at(surface, level);
    return sizeof(struct gd_limit_mesh) + vertices * BYTES_PER_VERTEX +
           3 * triangles * sizeof(uint32_t) + gd_mesh_build_cost(triangles, vertices);
}

/* --- building --------------------------------------------------------------------------------- */

/* Returns the bytes that a discretization holds. */
static size_t limit_mesh_bytes_of(const struct gd_discretization *fine)
{
    return (size_t)fine->polygons.position_count * BYTES_PER_VERTEX +
           3 * sizeof(uint32_t) * (size_t)fine->polygons.polygon_count;
}

static enum gd_status limit_mesh_build(struct gd_limit_mesh *fine, uint32_t max_faces,
                                       const struct gd_control *control, struct gd_detail *detail)
{
    struct gd__share share = {.control = control, .total = 2};
    struct gd_discretization made;
    const struct gd_discretize_options options = {.level = fine->level, .max_faces = max_faces};
    struct gd_control part = gd__share_control(&share, 0);
    enum gd_status status = gd_discretize(fine->surface, &options, &part, &made, detail);
    if (status) return status;
    share.done++;
    part = gd__share_control(&share, limit_mesh_bytes_of(&made));
    status = gd_mesh_build(&made.polygons, NULL, &part, &fine->mesh, detail);
    if (!status) {
        fine->normals = made.normals;
        made.normals = NULL;
    }
    gd_discretization_free(&made);
    return status;
}

enum gd_status gd_limit_mesh_build(const struct gd_subdivision *surface,
                                   const struct gd_limit_mesh_options *options,
                                   const struct gd_control *control, struct gd_limit_mesh **out,
                                   struct gd_detail *detail)
{
    struct gd_limit_mesh *fine = calloc(1, sizeof *fine);
    if (!fine) return GD_NO_MEMORY;
    fine->surface = gd_subdivision_retain(surface);
    fine->level = options->level;
    enum gd_status status = limit_mesh_build(fine, options->max_faces, control, detail);
    if (status) {
        gd_limit_mesh_free(fine);
        return status;
    }
    fine->cells = gd__level_cells(surface, options->level);
    *out = fine;
    return GD_OK;
}

void gd_limit_mesh_free(struct gd_limit_mesh *fine)
{
    if (!fine) return;
    gd_mesh_release(fine->mesh);
    gd_subdivision_release(fine->surface);
    free(fine->normals);
    free(fine);
}

size_t gd_limit_mesh_memsize(const struct gd_limit_mesh *fine)
{
    return sizeof *fine + gd_mesh_memsize(fine->mesh) +
           gd_mesh_summary(fine->mesh)->index_count * sizeof *fine->normals;
}

const struct gd_subdivision *gd_limit_mesh_surface(const struct gd_limit_mesh *fine)
{
    return fine->surface;
}

const struct gd_mesh *gd_limit_mesh_mesh(const struct gd_limit_mesh *fine)
{
    return fine->mesh;
}

const struct gd_vec3 *gd_limit_mesh_normals(const struct gd_limit_mesh *fine)
{
    return fine->normals;
}

uint32_t gd_limit_mesh_level(const struct gd_limit_mesh *fine)
{
    return fine->level;
}

/* --- cells and their triangles ---------------------------------------------------------------- */

/* Returns the number of a cell's first triangle, counted within its face. */
static uint32_t first_of_cell(const struct gd_limit_mesh *fine, uint32_t i, uint32_t j)
{
    return fine->surface->rules->arity == 4 ? 2 * (i * fine->cells + j)
                                            : 2 * (i * fine->cells + j) - i * i;
}

/* Returns true if a quad cell is divided from a to c, false if from b to d. If it is divided from a
 * to c, both triangles have the same first corner. */
static bool is_cut_from_a(const struct gd_limit_mesh *fine, uint32_t first)
{
    struct gd_vertex one[3], other[3];
    if (fine->surface->rules->arity == 3) return false;
    gd_mesh_corners(fine->mesh, (struct gd_face){first}, one);
    gd_mesh_corners(fine->mesh, (struct gd_face){first + 1}, other);
    return one[0].index == other[0].index;
}

static uint32_t face_base(const struct gd_limit_mesh *fine, uint32_t face)
{
    return face * (uint32_t)gd__face_triangles(fine->surface, fine->cells);
}

/* --- from places to points -------------------------------------------------------------------- */

enum gd_status gd_limit_mesh_point(const struct gd_limit_mesh *fine,
                                   const struct gd_limit_point *place, struct gd_point *out,
                                   struct gd_detail *detail)
{
    struct gd_limit_point inside = *place;
    enum gd_status status = gd__place_check(fine->surface, &inside, detail);
    if (status) return status;
    struct gd__face_place local = gd__face_place_of(fine->surface, &inside);
    struct gd__grid_cell cell =
        gd__grid_cell_of(fine->surface->rules->arity, fine->cells, local.s, local.t);
    uint32_t first = face_base(fine, local.face) + first_of_cell(fine, cell.i, cell.j);
    double weight[3];
    enum gd__half half = gd__grid_cell_split(&cell, is_cut_from_a(fine, first), weight);
    bool second = half == GD__HALF_ACD || half == GD__HALF_BCD;
    return gd_point_in_face(fine->mesh, (struct gd_face){first + second}, weight, out, detail);
}

/* --- from points to places -------------------------------------------------------------------- */

/* Returns the row of cells that contains triangle `n` of a Loop face. Row i begins at triangle i (2
 * cells - i). */
static uint32_t limit_mesh_row_of(uint32_t cells, uint32_t n)
{
    uint32_t low = 0, high = cells;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (middle * (2 * cells - middle) <= n)
            low = middle;
        else
            high = middle;
    }
    return low;
}

struct gd_limit_point gd_limit_mesh_place(const struct gd_limit_mesh *fine,
                                          const struct gd_point *point)
{
    struct gd_point_description known;
    gd_point_describe(fine->mesh, point, &known);
    bool triangles = fine->surface->rules->arity == 3;
    uint32_t face = known.face.index / (uint32_t)gd__face_triangles(fine->surface, fine->cells);
    uint32_t n = known.face.index - face_base(fine, face);
    uint32_t i = triangles ? limit_mesh_row_of(fine->cells, n) : n / (2 * fine->cells);
    uint32_t rest = n - first_of_cell(fine, i, 0), j = rest / 2;
    bool from_a = is_cut_from_a(fine, known.face.index - rest % 2), second = rest % 2;
    const uint8_t *corners = gd__half_corners[(from_a ? GD__HALF_ABC : GD__HALF_ABD) + second];
    double x = i, y = j;
    for (int k = 0; k < 3; k++) {
        x += known.barycentric[k] * gd__cell_corners[corners[k]][0];
        y += known.barycentric[k] * gd__cell_corners[corners[k]][1];
    }
    return gd__place_of(fine->surface,
                        &(struct gd__face_place){face, x / fine->cells, y / fine->cells});
}
