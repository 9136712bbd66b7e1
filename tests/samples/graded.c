#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"

/* Adds a vertex. Ring 0 is the rim, and ring k has the radius ratio^-k. The apex is the origin, so
 * that coordinates are exact relative to the smallest ring. */
static void add_vertex_of_ring(struct sample_builder *builder, const struct sample_grading *grading,
                               double turn, uint32_t ring, struct rng *rng)
{
    double height = grading->bend + grading->noise * rng_between(rng, -1, 1);
    double angle = turn + grading->noise * rng_between(rng, -1, 1) / grading->sectors;
    double r =
        pow(grading->ratio, -(double)ring) * (1 + 0.3 * grading->noise * rng_between(rng, -1, 1));
    sample_add_vertex(builder, r * cos(angle), r * sin(angle), ring ? r * (1 - r) * height : 0);
}

/* Adds the rings inside the rim, and the apex. If `is_back`, the sectors run clockwise seen from
 * outside. */
static void add_patch(struct sample_builder *builder, const struct sample_grading *grading,
                      bool is_back, struct rng *rng)
{
    uint32_t sectors = grading->sectors, outer = 0, first = builder->mesh.position_count;
    struct sample_grading own = *grading;
    if (is_back) own.bend = -own.bend;
    for (uint32_t ring = 1; ring <= grading->rings; ring++) {
        double turn = 2 * M_PI * rng_unit(rng) / sectors;
        for (uint32_t sector = 0; sector < sectors; sector++)
            add_vertex_of_ring(builder, &own, 2 * M_PI * sector / sectors + 0.5 * turn, ring, rng);
    }
    uint32_t apex = sample_add_vertex(builder, 0, 0, 0);
    for (uint32_t inner = first; inner <= apex; outer = inner, inner += sectors) {
        for (uint32_t i = 0; i < sectors; i++) {
            uint32_t next = (i + 1) % sectors, a = outer + (is_back ? next : i),
                     b = outer + (is_back ? i : next);
            uint32_t c = inner + (is_back ? i : next), d = inner + (is_back ? next : i);
            if (inner == apex)
                sample_add_triangle(builder, a, b, apex);
            else
                sample_add_quad(builder, a, b, c, d);
        }
    }
}

enum gd_status sample_graded(const struct sample_grading *grading, uint64_t seed,
                             struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    struct rng rng = {seed};
    for (uint32_t sector = 0; sector < grading->sectors; sector++)
        add_vertex_of_ring(&builder, grading, 2 * M_PI * sector / grading->sectors, 0, &rng);
    for (uint32_t patch = 0; patch < grading->patches; patch++)
        add_patch(&builder, grading, patch > 0, &rng);
    return sample_finish(&builder, out);
}
