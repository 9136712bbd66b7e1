#include "subdiv/walker.h"

#include "base/tolerance.h"
#include "subdiv/domain.h"
#include "subdiv/refine.h"

/* Sizes of the nets of a stage. They are large enough for the largest valence. */
struct sizes {
    size_t ring_faces, ring_points, refined_faces, refined_points;
};

static struct sizes sizes_of(const struct gd_subdivision *surface)
{
    size_t arity = surface->rules->arity, faces = arity * surface->largest_valence + 1;
    return (struct sizes){faces, arity * faces, 4 * faces, (2 * arity + 1) * faces};
}

static size_t walker_larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

enum gd_status gd__walker_create(struct gd__walker *walker, const struct gd_subdivision *surface,
                                 uint32_t stages, const struct gd_control *control)
{
    uint32_t arity = surface->rules->arity;
    struct sizes sizes = sizes_of(surface);
    size_t faces = walker_larger(surface->base.face_count, sizes.refined_faces);
    size_t points = walker_larger(surface->base.point_count, sizes.refined_points);
    struct gd__walker made = {
        .surface = surface, .piece.face = GD_NONE, .arena.budget.control = control};
    struct gd__arena *arena = &made.arena;
    made.fan.sides = gd__arena_take(arena, surface->largest_valence + 1, sizeof *made.fan.sides);
    made.face_stamp = gd__arena_zeroed(arena, faces, sizeof *made.face_stamp);
    made.face_at = gd__arena_take(arena, faces, sizeof *made.face_at);
    made.point_stamp = gd__arena_zeroed(arena, points, sizeof *made.point_stamp);
    made.point_at = gd__arena_take(arena, points, sizeof *made.point_at);
    made.cut_faces = gd__arena_take(arena, faces, sizeof *made.cut_faces);
    made.stages = gd__arena_take(arena, stages, sizeof *made.stages);
    for (uint32_t i = 0; !arena->status && i < stages; i++) {
        gd__net_create(&made.stages[i].ring, arena, arity, sizes.ring_points,
                       arity * sizes.ring_faces);
        gd__net_create(&made.stages[i].refined, arena, arity, sizes.refined_points,
                       arity * sizes.refined_faces);
    }
    if (arena->status)
        gd__walker_free(&made);
    else
        *walker = made;
    return arena->status;
}

void gd__walker_free(struct gd__walker *walker)
{
    gd__arena_free(&walker->arena);
}

static void take_face(struct gd__walker *walker, uint32_t face, uint32_t *count)
{
    if (walker->face_stamp[face] == walker->stamp) return;
    walker->face_stamp[face] = walker->stamp;
    walker->face_at[face] = *count;
    walker->cut_faces[(*count)++] = face;
}

/* Lists the face first, then the faces around its corners. Returns their number. */
static uint32_t take_faces(struct gd__walker *walker, const struct gd__net *from, uint32_t face)
{
    uint32_t count = 0;
    take_face(walker, face, &count);
    for (uint32_t k = 0; k < from->arity; k++) {
        gd__fan_around(from, face * from->arity + k, &walker->fan);
        for (uint32_t i = 0; i < walker->fan.count; i++)
            take_face(walker, gd__face_of(from, walker->fan.sides[i]), &count);
    }
    return count;
}

static uint32_t take_point(struct gd__walker *walker, const struct gd__net *from, uint32_t point,
                           struct gd_vec3 shift, struct gd__net *out)
{
    if (walker->point_stamp[point] != walker->stamp) {
        walker->point_stamp[point] = walker->stamp;
        walker->point_at[point] = out->point_count;
        out->corner[out->point_count] = from->corner[point];
        out->points[out->point_count++] = gd_vec3_sub(from->points[point], shift);
    }
    return walker->point_at[point];
}

static uint32_t cut_twin(const struct gd__walker *walker, uint32_t arity, uint32_t twin)
{
    if (twin == GD_NONE || walker->face_stamp[twin / arity] != walker->stamp) return GD_NONE;
    return arity * walker->face_at[twin / arity] + twin % arity;
}

static void next_stamp(struct gd__walker *walker)
{
    if (++walker->stamp) return;
    const struct gd_subdivision *surface = walker->surface;
    struct sizes sizes = sizes_of(surface);
    size_t faces = walker_larger(surface->base.face_count, sizes.refined_faces);
    size_t points = walker_larger(surface->base.point_count, sizes.refined_points);
    for (size_t i = 0; i < faces; i++) walker->face_stamp[i] = 0;
    for (size_t i = 0; i < points; i++) walker->point_stamp[i] = 0;
    walker->stamp = 1;
}

void gd__neighbourhood_extract(struct gd__walker *walker, const struct gd__net *from, uint32_t face,
                               struct gd__net *out, struct gd_vec3 *origin)
{
    next_stamp(walker);
    uint32_t arity = from->arity;
    struct gd_vec3 shift = from->points[from->origin[arity * face]];
    out->face_count = take_faces(walker, from, face);
    out->side_count = arity * out->face_count;
    out->point_count = 0;
    for (uint32_t side = 0; side < out->side_count; side++) {
        uint32_t old = arity * walker->cut_faces[side / arity] + side % arity;
        out->origin[side] = take_point(walker, from, from->origin[old], shift, out);
        out->sharpness[side] = from->sharpness[old];
        out->twin[side] = cut_twin(walker, arity, from->twin[old]);
    }
    *origin = gd_vec3_add(*origin, shift);
}

void gd__descend(struct gd__walker *walker, uint32_t from, uint32_t child, uint32_t to,
                 struct gd_vec3 *origin)
{
    struct gd__stage *stage = &walker->stages[from];
    gd__net_refine(&stage->ring, stage->ring.arity, &walker->fan, &stage->refined);
    gd__neighbourhood_extract(walker, &stage->refined, child, &walker->stages[to].ring, origin);
}

bool gd__cell_at(struct gd__walker *walker, const struct gd__face_place *local, double ds,
                 double dt, uint32_t *corner)
{
    const struct gd__scheme *rules = walker->surface->rules;
    struct gd__cell *piece = &walker->piece;
    double at[2] = {local->s, local->t};
    piece->face = local->face;
    piece->frame = GD__CHART_WHOLE;
    piece->slack = GD_TOL_PLACE;
    piece->origin = (struct gd_vec3){0};
    gd__neighbourhood_extract(walker, &walker->surface->base, local->face, &walker->stages[0].ring,
                              &piece->origin);
    for (uint32_t depth = 0; depth < GD__DEPTH_MOST; depth++) {
        struct gd__net *ring = &walker->stages[depth % 2].ring;
        if (gd__ring_is_regular(ring, &walker->fan)) {
            rules->patch(ring, &walker->fan, &piece->patch);
            return true;
        }
        uint32_t child = rules->child_at(at[0], at[1], ds, dt, piece->slack);
        const struct gd__child *way = &rules->children[child];
        double x = 2 * at[0] - way->origin[0], y = 2 * at[1] - way->origin[1];
        double us = ds, ut = dt;
        at[0] = x * way->t[1] - y * way->t[0], at[1] = way->s[0] * y - way->s[1] * x;
        ds = us * way->t[1] - ut * way->t[0], dt = way->s[0] * ut - way->s[1] * us;
        piece->frame = gd__chart_child(&piece->frame, way);
        piece->slack *= 2;
        gd__descend(walker, depth % 2, child, (depth + 1) % 2, &piece->origin);
    }
    /* the depth limit is reached only at a vertex */
    piece->face = GD_NONE;
    *corner = gd__nearest_corner(rules->arity, local->s, local->t);
    return false;
}

struct gd__jet gd__cell_jet(const struct gd__walker *walker, double s, double t)
{
    const struct gd__cell *piece = &walker->piece;
    double local[2];
    struct gd__jet jet;
    gd__chart_in(&piece->frame, s, t, local);
    walker->surface->rules->evaluate(&piece->patch, local[0], local[1], &jet);
    jet = gd__chart_jet(&piece->frame, &jet);
    jet.p = gd_vec3_add(jet.p, piece->origin);
    return jet;
}

void gd__corner_limit(struct gd__walker *walker, uint32_t face, uint32_t corner,
                      struct gd__vertex *out)
{
    struct gd_vec3 origin = {0};
    gd__neighbourhood_extract(walker, &walker->surface->base, face, &walker->stages[0].ring,
                              &origin);
    gd__vertex_limit(walker, 0, corner, 1, origin, out);
}
