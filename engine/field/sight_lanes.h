/* The sight's kernel for one set of lanes; included by sight_plain.c, sight_avx2.c and sight_avx512.c behind their lanes (wedge/lanes_*.h) and
 * what they add: load_first, starts_first and sources_first read the first lanes only, `gather` reads an array at the ids of a mask's lanes and
 * gives zero in the others, ids_below compares without signs, ids_scaled gives (a - from) * by, least_of the least of all lanes, `ordinals`
 * the lanes' numbers.
 *
 * In the frame of the point's side a source is at (x, -y), the point at (px, py). */
#include "field/sight.h"

/* Distances of the pseudo-sources; infinite of gaps. */
static inline lanes sigmas(const struct gd_field *field, ids source, mask here)
{
    uint32_t vertices = field->mesh->vertex_count;
    mask vertex = both(here, ids_below(source, vertices));
    lanes sigma = gather(vertex, field->distance, source);
    if (bits(vertex) == bits(here)) return sigma;
    enum { STRIDE = sizeof *field->seeds / sizeof field->seeds->offset };
    mask seed = except(except(here, vertex), ids_eq(source, ids_all(GD_NONE)));
    lanes offset = gather(seed, &field->seeds->offset, ids_scaled(source, vertices, STRIDE));
    return pick(vertex, sigma, pick(seed, offset, all(GD__FAR)));
}

/* Distances of the sight's point through the wedges from place `at` on; GD__FAR behind the last. */
static inline lanes distances(const struct gd_field *field, const struct gd__sight *sight, uint32_t at)
{
    struct gd__wedges wedges = gd__chunk_wedges(sight->chunk);
    uint32_t count = sight->chunk->count - at;
    mask here = first_lanes(count);
    lanes x = load_first(wedges.x + at, count), y = magnitude(load_first(wedges.y + at, count));
    lanes unit = all(sight->length * GD__WEDGE_UNIT), length = all(sight->length);
    lanes next = pick(first_lanes(count - 1), starts_first(wedges.start + at + 1, count - 1), all(GD__WEDGE_UNITS));
    lanes b0 = starts_first(wedges.start + at, count) * unit, b1 = next * unit;
    if (sight->side & 1) {
        lanes mirrored = length - b1;
        x = length - x;
        b1 = length - b0;
        b0 = mirrored;
    }
    lanes from = greater(b0 - (unit + unit), all(0)), to = lesser(b1 + (unit + unit), length);
    lanes px = all(sight->x), py = all(sight->y), dx = px - x, dy = py + y;
    lanes straight = pick(lt(all(0), dy), x + dx * (y / dy), px); /* sight.c has the same for one wedge */
    lanes bend = lesser(greater(straight, from), to), ex = bend - x, fx = px - bend;
    mask bends = either(lt(straight, from), lt(to, straight));
    lanes to_bend = pick(bends, ex * ex + y * y, dx * dx + dy * dy), onwards = pick(bends, fx * fx + py * py, all(0));
    lanes sigma = sigmas(field, sources_first(wedges.start + at, count), here);
    return pick(here, sigma + root(to_bend) + root(onwards), all(GD__FAR));
}

/* Nothing here branches on distances: none of it could be foreseen, and so queries overlap. */
struct gd__seen KERNEL(sight)(const struct gd_field *field, const struct gd__sight *sights, uint32_t count,
                              double known)
{
    lanes best = all(known), place = all(0);
    uint32_t before = 0;
    for (uint32_t s = 0; s < count; s++) {
        for (uint32_t at = 0; at < sights[s].chunk->count; at += LANES) {
            lanes distance = distances(field, &sights[s], at);
            mask better = lt(distance, best);
            best = pick(better, distance, best);
            place = pick(better, all(before + at), place);
        }
        before += sights[s].chunk->count;
    }
    double least = least_of(best);
    lanes winners = pick(eq(best, all(least)), place + ordinals(), all(GD__FAR));
    double first = least_of(winners);
    return (struct gd__seen){least, least < known ? (uint32_t)first : GD_NONE};
}
