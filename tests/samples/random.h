/* A small deterministic random number generator (splitmix64). The same seed gives the same sample
 * on every machine. */
#pragma once

#include <stdint.h>

struct rng {
    uint64_t state; /* the seed; any value is valid */
};

static inline uint64_t rng_next(struct rng *rng)
{
    uint64_t z = rng->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Returns a number uniformly distributed in [0,1). */
static inline double rng_unit(struct rng *rng)
{
    return (double)(rng_next(rng) >> 11) * 0x1p-53;
}

/* Returns a number uniformly distributed in [low,high). */
static inline double rng_between(struct rng *rng, double low, double high)
{
    return low + (high - low) * rng_unit(rng);
}

/* Returns a number uniformly distributed in 0 … count - 1. `count` must be greater than 0. */
static inline uint32_t rng_below(struct rng *rng, uint32_t count)
{
    return (uint32_t)(((rng_next(rng) >> 32) * count) >> 32);
}
