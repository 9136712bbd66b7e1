/* The view's kernel for one set of lanes; included by wedge_view_plain.c, wedge_view_avx2.c and
 * wedge_view_avx512.c behind their lanes (wedge/lanes_*.h) and what they add: load_first, starts_first
 * and sources_first read the first lanes only, `gather` reads an array at the ids of a mask's lanes
 * and gives zero in the others, ids_below compares without signs, ids_scaled gives (a - from) * by,
 * least_of the least of all lanes, `ordinals` the lanes' numbers.
 *
 * In the frame of the point's side a source is at (x, -y), the point at (px, py). */
#include "field/wedge_view.h"

/* Distances of the pseudo-sources that are points; infinite of gaps. */
static inline lanes sigmas(const struct gd_field *field, ids source, mask here)
{
    uint32_t vertices = field->mesh->vertex_count;
    mask vertex = both(here, ids_below(source, vertices));
    lanes sigma = gather(vertex, field->distance, source);
    if (bits(vertex) == bits(here)) return sigma;
    enum { STRIDE = sizeof *field->seeds / sizeof field->seeds->offset };
    mask seed = except(except(here, vertex), ids_top(source));
    lanes offset = gather(seed, &field->seeds->offset, ids_scaled(source, vertices, STRIDE));
    return pick(vertex, sigma, pick(seed, offset, all(GD__FAR)));
}

/* A group of wedges in the frame of the view's side. */
struct group {
    mask here;
    lanes x, y, b0, b1;
    ids source;
};

static inline struct group load_group(const struct gd__wedge_view *wedge_view, uint32_t at)
{
    struct gd__wedges wedges = gd__chunk_wedges(wedge_view->chunk);
    uint32_t count = wedge_view->chunk->count - at;
    struct group g;
    lanes unit = all(wedge_view->length * GD__WEDGE_UNIT), length = all(wedge_view->length);
    lanes next = pick(first_lanes(count - 1), starts_first(wedges.start + at + 1, count - 1),
                      all(GD__WEDGE_UNITS));
    g.here = first_lanes(count);
    g.x = load_first(wedges.x + at, count);
    g.y = magnitude(load_first(wedges.y + at, count));
    g.b0 = starts_first(wedges.start + at, count) * unit;
    g.b1 = next * unit;
    g.source = sources_first(wedges.start + at, count);
    if (wedge_view->side & 1) {
        lanes mirrored = length - g.b1;
        g.b1 = length - g.b0;
        g.b0 = mirrored;
    }
    return g;
}

/* Of ways through points' wedges. */
static inline lanes distances_of_points(const struct gd_field *field,
                                        const struct gd__wedge_view *wedge_view,
                                        const struct group *g)
{
    lanes x = g->x, y = g->y;
    if (wedge_view->side & 1) x = all(wedge_view->length) - x;
    lanes unit = all(wedge_view->length * GD__WEDGE_UNIT),
          from = greater(g->b0 - (unit + unit), all(0)),
          to = lesser(g->b1 + (unit + unit), all(wedge_view->length));
    lanes px = all(wedge_view->x), py = all(wedge_view->y), dx = px - x, dy = py + y;
    /* wedge_view.c has the same for one wedge */
    lanes straight = pick(lt(all(0), dy), x + dx * (y / dy), px);
    lanes bend = lesser(greater(straight, from), to), ex = bend - x, fx = px - bend;
    mask bends = either(lt(straight, from), lt(to, straight));
    lanes to_bend = pick(bends, ex * ex + y * y, dx * dx + dy * dy),
          onwards = pick(bends, fx * fx + py * py, all(0));
    return sigmas(field, g->source, g->here) + root(to_bend) + root(onwards);
}

/* Of ways through linear ones: the direction from its half angle's tangent, the distance at the
 * edge's origin. */
static inline lanes distances_of_lines(const struct gd__wedge_view *wedge_view,
                                       const struct group *g)
{
    lanes scale = all(1) / (all(1) + g->y * g->y), x = (all(1) - g->y) * (all(1) + g->y) * scale,
          y = (g->y + g->y) * scale, sigma = g->x;
    if (wedge_view->side & 1) {
        sigma = sigma - x * all(wedge_view->length);
        x = all(0) - x;
    }
    lanes px = all(wedge_view->x), py = all(wedge_view->y), straight = px + x * (py / y);
    lanes bend = lesser(greater(straight, g->b0), g->b1), fx = px - bend;
    mask bends = either(lt(straight, g->b0), lt(g->b1, straight));
    return pick(bends, sigma - x * bend + root(fx * fx + py * py), sigma - x * px + y * py);
}

/* What is compiled once for wedges of points only, and once for linear ones too. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* Distances of the view's point through the wedges from place `at` on; GD__FAR of gaps and behind
 * the last. */
BOTH_KINDS lanes distances(const struct gd_field *field, const struct gd__wedge_view *wedge_view,
                           uint32_t at, bool linear)
{
    struct group g = load_group(wedge_view, at);
    lanes distance = distances_of_points(field, wedge_view, &g);
    if (linear) {
        mask line = except(both(g.here, ids_top(g.source)), ids_eq(g.source, ids_all(GD_NONE)));
        if (bits(line)) distance = pick(line, distances_of_lines(wedge_view, &g), distance);
    }
    return pick(g.here, distance, all(GD__FAR));
}

/* Nothing here branches on distances: none of it could be foreseen, and so queries overlap. */
BOTH_KINDS struct gd__seen look(const struct gd_field *field,
                                const struct gd__wedge_view *wedge_views, uint32_t count,
                                double known, bool linear)
{
    lanes best = all(known), place = all(0);
    uint32_t before = 0;
    for (uint32_t s = 0; s < count; s++) {
        for (uint32_t at = 0; at < wedge_views[s].chunk->count; at += LANES) {
            lanes distance = distances(field, &wedge_views[s], at, linear);
            mask better = lt(distance, best);
            best = pick(better, distance, best);
            place = pick(better, all(before + at), place);
        }
        before += wedge_views[s].chunk->count;
    }
    double least = least_of(best);
    lanes winners = pick(eq(best, all(least)), place + ordinals(), all(GD__FAR));
    double first = least_of(winners);
    return (struct gd__seen){least, least < known ? (uint32_t)first : GD_NONE};
}

struct gd__seen KERNEL(wedge_view)(const struct gd_field *field,
                                   const struct gd__wedge_view *wedge_views, uint32_t count,
                                   double known)
{
    return look(field, wedge_views, count, known, false);
}

struct gd__seen KERNEL_LINEAR(wedge_view)(const struct gd_field *field,
                                          const struct gd__wedge_view *wedge_views, uint32_t count,
                                          double known)
{
    return look(field, wedge_views, count, known, true);
}
