#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"

/* Returns a number in [-1,1) for a lattice point of an octave. */
static double lattice_value(uint64_t seed, uint32_t octave, uint32_t i, uint32_t j)
{
    struct rng rng = {seed};
    rng.state = rng_next(&rng) + octave;
    rng.state = rng_next(&rng) + i;
    rng.state = rng_next(&rng) + j;
    return rng_between(&rng, -1, 1);
}

/* Returns the noise of one octave at (x,y) in the unit square. Interpolates bilinearly on a lattice
 * with 2^(octave + 1) cells per side. */
static double noise(uint64_t seed, uint32_t octave, double x, double y)
{
    double cells = ldexp(1, (int)octave + 1), u = x * cells, v = y * cells;
    uint32_t i = (uint32_t)u, j = (uint32_t)v;
    u -= i, v -= j;
    double low =
        (1 - u) * lattice_value(seed, octave, i, j) + u * lattice_value(seed, octave, i + 1, j);
    double high = (1 - u) * lattice_value(seed, octave, i, j + 1) +
                  u * lattice_value(seed, octave, i + 1, j + 1);
    return (1 - v) * low + v * high;
}

enum gd_status sample_terrain(uint32_t cells, double amplitude, uint64_t seed,
                              struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    for (uint32_t row = 0; row <= cells; row++) {
        for (uint32_t column = 0; column <= cells; column++) {
            double x = (double)column / cells, y = (double)row / cells, z = 0;
            for (uint32_t octave = 0; 1u << octave <= cells; octave++)
                z += amplitude * pow(0.55, octave) * noise(seed, octave, x, y);
            sample_add_vertex(&builder, x, y, z);
        }
    }
    sample_add_lattice(&builder, (struct sample_lattice){.columns = cells + 1, .rows = cells + 1});
    return sample_finish(&builder, out);
}
