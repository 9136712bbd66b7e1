#include "subdiv/tiling.h"

#include <string.h>

enum gd_status gd__tiling_create(const struct gd_subdivision *surface, uint32_t level,
                                 struct gd__tiling *out)
{
    const struct gd__net *base = &surface->base;
    struct gd__arena *arena = &out->arena;
    uint32_t edges = surface->base_edges;
    *out = (struct gd__tiling){.surface = surface};
    out->face_level = gd__arena_take(arena, base->face_count, sizeof *out->face_level);
    out->edge_level = gd__arena_take(arena, edges, sizeof *out->edge_level);
    out->point = gd__arena_take(arena, base->point_count, sizeof *out->point);
    out->edge_first = gd__arena_take(arena, edges, sizeof *out->edge_first);
    out->face_first = gd__arena_take(arena, base->face_count, sizeof *out->face_first);
    if (!arena->status) memset(out->face_level, (int)level, base->face_count);
    return arena->status;
}

static void level_edges(struct gd__tiling *tiling)
{
    const struct gd__net *base = &tiling->surface->base;
    memset(tiling->edge_level, 0, tiling->surface->base_edges);
    for (uint32_t side = 0; side < base->side_count; side++) {
        uint8_t *edge = &tiling->edge_level[base->edge[side]],
                face = tiling->face_level[side / base->arity];
        *edge = *edge > face ? *edge : face;
    }
}

static void number_points(struct gd__tiling *tiling)
{
    const struct gd__net *base = &tiling->surface->base;
    for (uint32_t i = 0; i < base->point_count; i++) tiling->point[i] = GD_NONE;
    for (uint32_t side = 0; side < base->side_count; side++) tiling->point[base->origin[side]] = 0;
    for (uint32_t i = 0; i < base->point_count; i++) {
        if (tiling->point[i] != GD_NONE) tiling->point[i] = (uint32_t)tiling->vertices++;
    }
}

static uint64_t inside_count(uint32_t arity, uint64_t cells)
{
    return arity == 4 ? (cells - 1) * (cells - 1) : cells < 2 ? 0 : (cells - 1) * (cells - 2) / 2;
}

/* Returns the number of a face's triangles: those of the face's cells, and the additional ones at
 * edges that are finer than the face. */
static uint64_t triangle_count(const struct gd__tiling *tiling, uint32_t face)
{
    const struct gd__net *base = &tiling->surface->base;
    uint32_t arity = base->arity;
    uint64_t cells = 1ull << tiling->face_level[face], count = (arity == 4 ? 2 : 1) * cells * cells;
    for (uint32_t k = 0; k < arity; k++)
        count += (1ull << tiling->edge_level[base->edge[arity * face + k]]) - cells;
    return count;
}

enum gd_status gd__tiling_number(struct gd__tiling *tiling, uint64_t most)
{
    const struct gd__net *base = &tiling->surface->base;
    tiling->vertices = tiling->triangles = 0;
    level_edges(tiling);
    for (uint32_t face = 0; face < base->face_count; face++)
        tiling->triangles += triangle_count(tiling, face);
    /* with fewer than 2^30 triangles, vertex numbers fit into 32 bits */
    if (tiling->triangles > most) return GD_TOO_LARGE;
    number_points(tiling);
    for (uint32_t edge = 0; edge < tiling->surface->base_edges; edge++) {
        tiling->edge_first[edge] = (uint32_t)tiling->vertices;
        tiling->vertices += (1u << tiling->edge_level[edge]) - 1;
    }
    for (uint32_t face = 0; face < base->face_count; face++) {
        tiling->face_first[face] = (uint32_t)tiling->vertices;
        tiling->vertices += inside_count(base->arity, 1ull << tiling->face_level[face]);
    }
    return GD_OK;
}

uint32_t gd__tiling_finest(const struct gd__tiling *tiling, uint32_t face)
{
    const struct gd__net *base = &tiling->surface->base;
    uint32_t finest = tiling->face_level[face];
    for (uint32_t side = base->arity * face; side < base->arity * (face + 1); side++) {
        uint32_t level = tiling->edge_level[base->edge[side]];
        finest = level > finest ? level : finest;
    }
    return finest;
}

uint32_t gd__tiling_on_side(const struct gd__tiling *tiling, uint32_t side, uint32_t m)
{
    const struct gd__net *base = &tiling->surface->base;
    uint32_t edge = base->edge[side], cells = 1u << tiling->edge_level[edge];
    if (m == 0) return tiling->point[base->origin[side]];
    if (m == cells) return tiling->point[gd__side_end(base, side)];
    bool owner = base->twin[side] > side;
    return tiling->edge_first[edge] + (owner ? m : cells - m) - 1;
}

uint32_t gd__tiling_inside(const struct gd__tiling *tiling, uint32_t face, uint32_t cells,
                           uint32_t i, uint32_t j)
{
    uint32_t before = (i - 1) * (cells - 1);
    if (tiling->surface->rules->arity == 3) before -= i * (i - 1) / 2;
    return tiling->face_first[face] + before + j - 1;
}

void gd__side_place(uint32_t arity, uint32_t k, uint32_t cells, uint32_t m, uint32_t out[2])
{
    uint32_t rest = cells - m;
    const uint32_t quad[4][2] = {{m, 0}, {cells, m}, {rest, cells}, {0, rest}},
                   triangle[3][2] = {{m, 0}, {rest, m}, {0, rest}};
    memcpy(out, arity == 4 ? quad[k] : triangle[k], 2 * sizeof *out);
}
