/* Computes the triangles of one face. */
#include "subdiv/tiling.h"

static uint32_t *triangle(uint32_t *corners, uint32_t a, uint32_t b, uint32_t c)
{
    corners[0] = a, corners[1] = b, corners[2] = c;
    return corners + 3;
}

static double square_distance(const double *a, const double *b)
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* Divides a quad with the counter-clockwise corners v along its shorter diagonal. If both are
 * equally long, divides it from v[0] to v[2]. */
static uint32_t *quad(const double (*positions)[3], const uint32_t v[4], uint32_t *corners)
{
    bool first = square_distance(positions[v[0]], positions[v[2]]) <=
                 square_distance(positions[v[1]], positions[v[3]]);
    corners = triangle(corners, v[0], v[1], v[first ? 2 : 3]);
    return first ? triangle(corners, v[0], v[2], v[3]) : triangle(corners, v[1], v[2], v[3]);
}

/* Returns the vertex at (i,j) of a face whose edges have the face's own level. */
static uint32_t vertex_at(const struct gd__tiling *tiling, uint32_t face, uint32_t cells,
                          uint32_t i, uint32_t j)
{
    uint32_t arity = tiling->surface->rules->arity, first = arity * face;
    if (j == 0) return gd__tiling_on_side(tiling, first, i);
    if (i == 0) return gd__tiling_on_side(tiling, first + arity - 1, cells - j);
    if (arity == 3 && i + j == cells) return gd__tiling_on_side(tiling, first + 1, j);
    if (arity == 4 && i == cells) return gd__tiling_on_side(tiling, first + 1, j);
    if (arity == 4 && j == cells) return gd__tiling_on_side(tiling, first + 2, cells - i);
    return gd__tiling_inside(tiling, face, cells, i, j);
}

struct tiled {
    const struct gd__tiling *tiling;
    uint32_t face;
    const double (*positions)[3];
    struct gd__pace *pace;
};

/* Appends the triangles of the cells (i,j) with low <= i, j < high (Loop: i + j < high). */
static uint32_t *tile_cells(const struct tiled *tiled, uint32_t low, uint32_t high,
                            uint32_t *corners)
{
    const struct gd__tiling *tiling = tiled->tiling;
    uint32_t face = tiled->face, cells = 1u << tiling->face_level[face];
    bool triangles = tiling->surface->rules->arity == 3;
    for (uint32_t i = low; i < high && gd__pace(tiled->pace, high - low); i++) {
        uint32_t last = triangles ? high - i : high;
        if (last <= low) break;
        uint32_t a = vertex_at(tiling, face, cells, i, low),
                 b = vertex_at(tiling, face, cells, i + 1, low);
        for (uint32_t j = low; j < last; j++) {
            uint32_t d = vertex_at(tiling, face, cells, i, j + 1);
            bool half = triangles && j + 1 == last;
            uint32_t c = half ? GD_NONE : vertex_at(tiling, face, cells, i + 1, j + 1);
            if (triangles) {
                corners = triangle(corners, a, b, d);
                if (!half) corners = triangle(corners, b, c, d);
            } else {
                corners = quad(tiled->positions, (uint32_t[4]){a, b, c, d}, corners);
            }
            a = d;
            b = c;
        }
    }
    return corners;
}

/* Returns vertex n of the row of inner vertices next to side k. */
static uint32_t inner_vertex(const struct gd__tiling *tiling, uint32_t face, uint32_t k, uint32_t n)
{
    uint32_t cells = 1u << tiling->face_level[face], m = n + 1, rest = cells - m;
    if (tiling->surface->rules->arity == 3) {
        const uint32_t at[3][2] = {{m, 1}, {rest - 1, m}, {1, rest - 1}};
        return gd__tiling_inside(tiling, face, cells, at[k][0], at[k][1]);
    }
    const uint32_t at[4][2] = {{m, 1}, {cells - 1, m}, {rest, cells - 1}, {1, rest}};
    return gd__tiling_inside(tiling, face, cells, at[k][0], at[k][1]);
}

/* Fills the strip between a side and the row of inner vertices next to it. Each triangle adds one
 * vertex: the next vertex of the side or of the row, whichever comes first along the side. */
static uint32_t *tile_strip(const struct gd__tiling *tiling, uint32_t face, uint32_t k,
                            uint32_t *corners)
{
    const struct gd__net *base = &tiling->surface->base;
    uint32_t side = base->arity * face + k;
    uint32_t outer_cells = 1u << tiling->edge_level[base->edge[side]],
             cells = 1u << tiling->face_level[face];
    uint32_t inner_cells = base->arity == 4 ? cells - 2 : cells - 3;
    double shift = base->arity == 4 ? 1 : 1.5;
    uint32_t outer = gd__tiling_on_side(tiling, side, 0), inner = inner_vertex(tiling, face, k, 0);
    for (uint32_t m = 0, n = 0; m < outer_cells || n < inner_cells;) {
        double next_outer = (m + 0.5) / outer_cells, next_inner = (n + 0.5 + shift) / cells;
        bool outwards = n == inner_cells || (m < outer_cells && next_outer <= next_inner);
        if (outwards) {
            uint32_t next = gd__tiling_on_side(tiling, side, ++m);
            corners = triangle(corners, outer, next, inner);
            outer = next;
        } else {
            uint32_t next = inner_vertex(tiling, face, k, ++n);
            corners = triangle(corners, outer, next, inner);
            inner = next;
        }
    }
    return corners;
}

uint32_t *gd__tile(const struct gd__tiling *tiling, uint32_t face, const double (*positions)[3],
                   uint32_t *corners, struct gd__pace *pace)
{
    const struct tiled tiled = {tiling, face, positions, pace};
    uint32_t level = tiling->face_level[face], cells = 1u << level,
             arity = tiling->surface->rules->arity;
    if (gd__tiling_finest(tiling, face) == level) return tile_cells(&tiled, 0, cells, corners);
    corners = tile_cells(&tiled, 1, cells - 1, corners);
    for (uint32_t k = 0; k < arity; k++) corners = tile_strip(tiling, face, k, corners);
    return corners;
}
