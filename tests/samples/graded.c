#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"

/* The ring's vertices, at equal angles up to the jitter. */
static void add_ring(struct sample_builder *builder, const struct sample_grading *grading, double radius,
                     struct rng *rng)
{
    double turn = 2 * M_PI / grading->sides * grading->jitter * rng_unit(rng);
    for (uint32_t i = 0; i < grading->sides; i++) {
        double angle = turn + 2 * M_PI / grading->sides * (i + grading->jitter * rng_between(rng, -0.5, 0.5));
        double r = radius * (1 + grading->jitter * rng_between(rng, -0.3, 0.3));
        double height = grading->bend * (0.5 + grading->jitter * rng_between(rng, -1, 1));
        sample_add_vertex(builder, r * cos(angle), r * sin(angle), r * height);
    }
}

enum gd_status sample_graded(const struct sample_grading *grading, uint64_t seed, struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    struct rng rng = {seed};
    uint32_t sides = grading->sides;
    sample_add_vertex(&builder, 0, 0, 0);
    for (uint32_t ring = 0; ring < grading->rings; ring++) {
        add_ring(&builder, grading, pow(grading->ratio, (double)ring + 1 - grading->rings), &rng);
        for (uint32_t i = 0; i < sides; i++) {
            uint32_t outer = 1 + ring * sides, next = (i + 1) % sides, inner = outer - sides;
            if (ring == 0)
                sample_add_triangle(&builder, 0, outer + i, outer + next);
            else
                sample_add_quad(&builder, inner + i, outer + i, outer + next, inner + next);
        }
    }
    return sample_finish(&builder, out);
}
