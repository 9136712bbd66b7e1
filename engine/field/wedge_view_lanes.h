/* The view kernel for one set of vector instructions (lanes). wedge_view_plain.c, wedge_view_avx2.c
 * and wedge_view_avx512.c include it after the lanes' primitives (kernel/lanes_*.h). Each of these
 * files defines these additional primitives:
 *     load_first, starts_first,
 *     ids_first                  read the first lanes; other lanes are undefined
 *     load_packed                reads x, y and the sources of a packed chunk; gd__wedge_zero must
 *                                be subtracted from x and y
 *     gather                     reads an array at the ids of a mask's lanes; 0 in other lanes
 *     ids_below                  compares ids as unsigned integers
 *     ids_scaled                 returns (a - from) * by
 *     ordinals                   the numbers of the lanes: 0, 1, ...
 *
 * In the frame of the point's side a source is at (x, -y), the point at (px, py). */
#include "field/wedge_view.h"

/* Returns the distances of the pseudo-sources; infinite for gaps. */
static inline lanes sigmas(const struct gd_field *field, ids source, mask here)
{
    uint32_t vertices = field->mesh->vertex_count;
    mask vertex = both(here, ids_below(source, vertices));
    lanes sigma = gather(vertex, field->distance, source);
    if (bits(vertex) == bits(here)) return sigma;
    enum { STRIDE = sizeof *field->seeds / sizeof field->seeds->offset };
    mask seed = except(both(here, ids_below(source, vertices + field->seed_count)), vertex);
    lanes offset = gather(seed, &field->seeds->offset, ids_scaled(source, vertices, STRIDE));
    return pick(vertex, sigma, pick(seed, offset, all(GD__FAR)));
}

/* A group of wedges in the frame of the view's side. */
struct group {
    mask here;
    lanes x, y, b0, b1;
    ids source;
};

static inline struct group load_group(const struct gd__wedge_view *wedge_view,
                                      const struct gd__wedges *wedges, uint32_t at)
{
    uint32_t count = wedges->count - at;
    struct group g;
    lanes unit = all(wedge_view->length * GD__WEDGE_UNIT), length = all(wedge_view->length);
    lanes next = pick(first_lanes(count - 1), starts_first(wedges->start + at + 1, count - 1),
                      all(GD__WEDGE_UNITS));
    g.here = first_lanes(count);
    if (wedges->form == GD__WEDGE_WIDE) {
        g.x = load_first(wedges->x + at, count);
        g.y = load_first(wedges->y + at, count);
        g.source = ids_first(wedges->high + at, count);
    } else {
        struct gd__wedge_zero zero = gd__wedge_zero(wedges->exponent);
        g.source = load_packed(wedges, at, &zero, &g.x, &g.y);
        g.x = g.x - all(zero.x);
        g.y = g.y - all(zero.y);
    }
    g.b0 = starts_first(wedges->start + at, count) * unit;
    g.b1 = next * unit;
    if (wedge_view->side & 1) {
        lanes mirrored = length - g.b1;
        g.b1 = length - g.b0;
        g.b0 = mirrored;
    }
    return g;
}

/* Returns the distances through wedges of points. */
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
    /* leg.c repeats this computation for a single wedge */
    lanes straight = pick(lt(all(0), dy), x + dx * (y / dy), px);
    lanes bend = lesser(greater(straight, from), to), ex = bend - x, fx = px - bend;
    mask bends = either(lt(straight, from), lt(to, straight));
    lanes to_bend = pick(bends, ex * ex + y * y, dx * dx + dy * dy),
          onwards = pick(bends, fx * fx + py * py, all(0));
    return sigmas(field, g->source, g->here) + root(to_bend) + root(onwards);
}

/* Returns the distances through linear wedges. A linear wedge stores the tangent of half the angle
 * of its direction, and the distance at the edge's origin. */
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

/* The functions below are compiled twice: for wedges of points only, and for point and linear
 * wedges. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* Returns the distances of the point through the wedges beginning with number `at`; GD__FAR for
 * gaps and beyond the last wedge. */
BOTH_KINDS lanes distances(const struct gd_field *field, const struct gd__wedge_view *wedge_view,
                           const struct gd__wedges *wedges, uint32_t at, bool linear)
{
    struct group g = load_group(wedge_view, wedges, at);
    lanes distance = distances_of_points(field, wedge_view, &g);
    if (linear) {
        mask line = except(both(g.here, ids_top(g.source)), ids_eq(g.source, ids_all(GD_NONE)));
        if (bits(line)) distance = pick(line, distances_of_lines(wedge_view, &g), distance);
    }
    return pick(g.here, distance, all(GD__FAR));
}

/* Finds the shortest path. Uses no branches on distances, which would be unpredictable, so that the
 * processor overlaps queries. */
BOTH_KINDS struct gd__wedge_view_best look(const struct gd_field *field,
                                           const struct gd__wedge_view *wedge_views, uint32_t count,
                                           double known, bool linear)
{
    lanes best = all(known), place = all(0);
    uint32_t before = 0;
    for (uint32_t s = 0; s < count; s++) {
        struct gd__wedges wedges = gd__chunk_wedges(wedge_views[s].chunk);
        for (uint32_t at = 0; at < wedges.count; at += LANES) {
            lanes distance = distances(field, &wedge_views[s], &wedges, at, linear);
            mask better = lt(distance, best);
            best = pick(better, distance, best);
            place = pick(better, all(before + at), place);
        }
        before += wedges.count;
    }
    double least = least_of(best);
    lanes winners = pick(eq(best, all(least)), place + ordinals(), all(GD__FAR));
    double first = least_of(winners);
    return (struct gd__wedge_view_best){least, least < known ? (uint32_t)first : GD_NONE};
}

struct gd__wedge_view_best KERNEL(wedge_view)(const struct gd_field *field,
                                              const struct gd__wedge_view *wedge_views,
                                              uint32_t count, double known)
{
    return look(field, wedge_views, count, known, false);
}

struct gd__wedge_view_best KERNEL_LINEAR(wedge_view)(const struct gd_field *field,
                                                     const struct gd__wedge_view *wedge_views,
                                                     uint32_t count, double known)
{
    return look(field, wedge_views, count, known, true);
}
