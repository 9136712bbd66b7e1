/* Hash of an integer. */
#pragma once

#include <stdint.h>

/* The finaliser of splitmix64: every bit of `x` influences every bit of the result. */
static inline uint64_t gd__hash(uint64_t x)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}
