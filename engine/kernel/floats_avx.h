/* Floats in AVX, eight at a time, for the AVX2 and AVX-512 kernels (lanes_avx2.h,
 * lanes_avx512.h). */
#pragma once

#include <immintrin.h>

#define FLOATS 8

typedef __m256 floats;

static inline floats floats_all(float a)
{
    return _mm256_set1_ps(a);
}
static inline floats floats_load(const float *p)
{
    return _mm256_loadu_ps(p);
}
static inline floats floats_root(floats a)
{
    return _mm256_sqrt_ps(a);
}
static inline floats floats_lesser(floats a, floats b)
{
    return _mm256_min_ps(a, b);
}
static inline floats floats_greater(floats a, floats b)
{
    return _mm256_max_ps(a, b);
}
static inline float floats_least(floats a)
{
    __m128 half = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    half = _mm_min_ps(half, _mm_movehl_ps(half, half));
    return _mm_cvtss_f32(_mm_min_ss(half, _mm_movehdup_ps(half)));
}
