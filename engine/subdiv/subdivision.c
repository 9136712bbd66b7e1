#include "gd/subdivision.h"

#include <math.h>
#include <stdlib.h>

#include "subdiv/connect.h"
#include "subdiv/refine.h"
#include "subdiv/surface.h"

enum { SIDES_MOST = 1 << 26 };

/* Refines a mesh with polygons once, so that all base faces are quads. */
static enum gd_status subdivision_split(struct gd_subdivision *surface, struct gd__net *control,
                                        struct gd__arena *scratch)
{
    struct gd__arena *arena = &surface->arena;
    size_t points = (size_t)control->point_count + gd__number_edges(control) + control->face_count;
    struct gd__fan fan = {.sides = gd__arena_take(scratch, control->side_count, sizeof *fan.sides)};
    gd__net_create(&surface->base, arena, 4, points, 4 * (size_t)control->side_count);
    surface->split_first =
        gd__arena_take(arena, control->face_count + (size_t)1, sizeof *surface->split_first);
    if (scratch->status || arena->status) return GD_NO_MEMORY;
    for (uint32_t face = 0; face <= control->face_count; face++)
        surface->split_first[face] = gd__face_first(control, face);
    gd__net_refine(control, control->point_count, &fan, &surface->base);
    return GD_OK;
}

/* For each point, the number of its edges, and whether it is on the boundary. A boundary point has
 * one edge more than faces. */
struct census {
    uint32_t *edges;
    bool *open;
};

static struct census take_census(const struct gd__net *net, struct gd__arena *scratch)
{
    struct census census = {gd__arena_zeroed(scratch, net->point_count, sizeof *census.edges),
                            gd__arena_zeroed(scratch, net->point_count, sizeof *census.open)};
    for (uint32_t side = 0; !scratch->status && side < net->side_count; side++) {
        census.edges[net->origin[side]]++;
        if (net->twin[side] != GD_NONE) continue;
        census.edges[gd__side_end(net, side)]++;
        census.open[net->origin[side]] = true;
    }
    return census;
}

static uint32_t largest_valence(const struct gd__net *net, const struct census *census,
                                uint32_t least)
{
    uint32_t largest = least;
    for (uint32_t i = 0; i < net->point_count; i++)
        largest = census->edges[i] > largest ? census->edges[i] : largest;
    return largest;
}

/* Counts the extraordinary points of each valence. `valences` has room for an entry for each
 * valence up to `largest`. */
static uint32_t count_extraordinary(const struct gd__net *net, const struct census *census,
                                    uint32_t regular, uint32_t largest, struct gd_valence *valences)
{
    for (uint32_t v = 0; v <= largest; v++) valences[v] = (struct gd_valence){v, 0};
    for (uint32_t i = 0; i < net->point_count; i++) {
        uint32_t valence = census->edges[i];
        if (valence > 0 && valence != regular && !census->open[i]) valences[valence].count++;
    }
    uint32_t count = 0;
    for (uint32_t v = 0; v <= largest; v++) {
        if (valences[v].count > 0) valences[count++] = valences[v];
    }
    return count;
}

static uint32_t count_loops(const struct gd__net *net, struct gd__arena *scratch)
{
    uint32_t loops = 0;
    bool *seen = gd__arena_zeroed(scratch, net->side_count, sizeof *seen);
    for (uint32_t begin = 0; seen && begin < net->side_count; begin++) {
        if (net->twin[begin] != GD_NONE || seen[begin]) continue;
        loops++;
        for (uint32_t side = begin; !seen[side];) {
            seen[side] = true;
            side = gd__net_next(net, side);
            while (net->twin[side] != GD_NONE) side = gd__net_next(net, net->twin[side]);
        }
    }
    return loops;
}

static void count_edges(const struct gd__net *net, const struct gd_control_mesh *mesh,
                        uint32_t edges, struct gd_subdivision_summary *out)
{
    out->vertex_count = net->point_count;
    out->edge_count = edges;
    out->face_count = net->face_count;
    for (uint32_t side = 0; side < net->side_count; side++) {
        uint32_t twin = net->twin[side];
        out->boundary_edges += twin == GD_NONE;
        out->crease_edges += twin != GD_NONE && side < twin && net->sharpness[side] > 0;
    }
    for (uint32_t i = 0; i < mesh->corner_count; i++)
        out->corner_vertices += mesh->corners[i].sharpness > 0;
}

static enum gd_status summarise(struct gd_subdivision *surface, struct gd__net *control,
                                const struct gd_control_mesh *mesh, struct gd__arena *scratch)
{
    struct gd_subdivision_summary *summary = &surface->summary;
    struct census census = take_census(control, scratch);
    summary->boundary_loops = count_loops(control, scratch);
    if (scratch->status) return scratch->status;
    uint32_t regular = surface->rules->valence,
             largest = largest_valence(control, &census, regular);
    surface->largest_valence = largest;
    surface->valences =
        gd__arena_take(&surface->arena, largest + (size_t)1, sizeof *surface->valences);
    if (!surface->valences) return GD_NO_MEMORY;
    count_edges(control, mesh, gd__number_edges(control), summary);
    summary->extraordinary_count =
        count_extraordinary(control, &census, regular, largest, surface->valences);
    summary->extraordinary = surface->valences;
    return GD_OK;
}

/* Updates the largest valence after polygons were split. The middle of each polygon becomes a
 * vertex with as many edges as the polygon has corners. */
static void widen_valence(struct gd_subdivision *surface)
{
    for (uint32_t face = 0; surface->split_first && face < surface->control_faces; face++) {
        uint32_t corners = surface->split_first[face + 1] - surface->split_first[face];
        if (corners > surface->largest_valence) surface->largest_valence = corners;
    }
}

static struct gd__box joined(struct gd__box a, struct gd__box b)
{
    return (struct gd__box){
        {fmin(a.low.x, b.low.x), fmin(a.low.y, b.low.y), fmin(a.low.z, b.low.z)},
        {fmax(a.high.x, b.high.x), fmax(a.high.y, b.high.y), fmax(a.high.z, b.high.z)}};
}

/* Computes the box of each face's one-ring: first the boxes of each face's corners, then their
 * union around each point, then the union over each face's points. */
static enum gd_status make_boxes(struct gd_subdivision *surface, struct gd__arena *scratch)
{
    const struct gd__net *base = &surface->base;
    const struct gd__box none = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    struct gd__box *around = gd__arena_take(scratch, base->point_count, sizeof *around);
    surface->boxes = gd__arena_take(&surface->arena, base->face_count, sizeof *surface->boxes);
    if (!around || !surface->boxes) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < base->point_count; i++) around[i] = none;
    for (uint32_t face = 0; face < base->face_count; face++) {
        const uint32_t *corners = base->origin + (size_t)base->arity * face;
        struct gd__box box = none;
        for (uint32_t k = 0; k < base->arity; k++) {
            struct gd_vec3 p = base->points[corners[k]];
            box = joined(box, (struct gd__box){p, p});
        }
        for (uint32_t k = 0; k < base->arity; k++)
            around[corners[k]] = joined(around[corners[k]], box);
    }
    for (uint32_t face = 0; face < base->face_count; face++) {
        surface->boxes[face] = none;
        for (uint32_t k = 0; k < base->arity; k++)
            surface->boxes[face] =
                joined(surface->boxes[face], around[base->origin[base->arity * face + k]]);
    }
    return GD_OK;
}

static void subdivision_measure(struct gd_subdivision *surface)
{
    struct gd__box all = surface->boxes[0];
    for (uint32_t face = 1; face < surface->base.face_count; face++)
        all = joined(all, surface->boxes[face]);
    struct gd_vec3 extent = gd_vec3_sub(all.high, all.low);
    surface->size = fmax(extent.x, fmax(extent.y, extent.z));
}

static enum gd_status subdivision_adopt(struct gd_subdivision *surface, struct gd__net *control,
                                        const struct gd_control_mesh *mesh,
                                        struct gd__arena *scratch)
{
    surface->control_faces = control->face_count;
    enum gd_status status = summarise(surface, control, mesh, scratch);
    if (status) return status;
    if (control->first) {
        status = subdivision_split(surface, control, scratch);
        if (status) return status;
        widen_valence(surface);
        surface->control = *control;
    } else {
        surface->base = *control;
    }
    surface->base_edges = gd__number_edges(&surface->base);
    status = make_boxes(surface, scratch);
    if (!status) subdivision_measure(surface);
    return status;
}

static enum gd_status subdivision_build(struct gd_subdivision *surface,
                                        const struct gd_control_mesh *mesh,
                                        struct gd_detail *detail)
{
    struct gd__net control;
    struct gd__connecting connecting = {.arena = &surface->arena};
    enum gd_status status =
        gd__net_connect(&mesh->polygons, surface->rules->arity, &connecting, &control, detail);
    if (!status) status = gd__apply_tags(mesh, &connecting, &control, detail);
    if (!status) status = subdivision_adopt(surface, &control, mesh, &connecting.scratch);
    gd__arena_free(&connecting.scratch);
    return status;
}

enum gd_status gd_subdivision_create(const struct gd_control_mesh *control_mesh,
                                     enum gd_scheme scheme, const struct gd_control *control,
                                     struct gd_subdivision **out, struct gd_detail *detail)
{
    size_t sides = control_mesh->polygons.polygon_count
                       ? gd_polygons_corner_count(&control_mesh->polygons)
                       : 0;
    if (sides > SIDES_MOST)
        return gd_fail(detail, GD_TOO_LARGE,
                       "the control mesh's faces have %zu corners in all: at most %d are taken",
                       sides, SIDES_MOST);
    enum gd_status status = gd_control_check(control, 0);
    if (!status) status = gd_control_afford(control, 200 * sides);
    if (status) return status;
    struct gd_subdivision *surface = calloc(1, sizeof *surface);
    if (!surface) return GD_NO_MEMORY;
    atomic_init(&surface->references, 1);
    surface->scheme = scheme;
    surface->rules = scheme == GD_SCHEME_LOOP ? &gd__loop : &gd__catmull_clark;
    status = subdivision_build(surface, control_mesh, detail);
    if (!status) status = gd_control_check(control, 1);
    if (status)
        gd_subdivision_release(surface);
    else
        *out = surface;
    return status;
}

struct gd_subdivision *gd_subdivision_retain(const struct gd_subdivision *surface)
{
    gd__references_add(&surface->references);
    return (struct gd_subdivision *)surface;
}

void gd_subdivision_release(const struct gd_subdivision *surface)
{
    if (!surface || !gd__references_drop(&surface->references)) return;
    struct gd_subdivision *shared = (struct gd_subdivision *)surface;
    gd__arena_free(&shared->arena);
    free(shared);
}

size_t gd_subdivision_memsize(const struct gd_subdivision *surface)
{
    return sizeof *surface + surface->arena.budget.held;
}

enum gd_scheme gd_subdivision_scheme(const struct gd_subdivision *surface)
{
    return surface->scheme;
}

struct gd_subdivision_summary gd_subdivision_summary(const struct gd_subdivision *surface)
{
    return surface->summary;
}

static const struct gd__net *control_net(const struct gd_subdivision *surface)
{
    return surface->split_first ? &surface->control : &surface->base;
}

const struct gd_vec3 *gd_subdivision_control_points(const struct gd_subdivision *surface)
{
    return control_net(surface)->points;
}

void gd_subdivision_control_edges(const struct gd_subdivision *surface, uint32_t (*out)[2])
{
    const struct gd__net *net = control_net(surface);
    for (uint32_t side = 0; side < net->side_count; side++) {
        if (net->twin[side] < side) continue; /* the boundary has GD_NONE */
        (*out)[0] = net->origin[side];
        (*out++)[1] = gd__side_end(net, side);
    }
}
