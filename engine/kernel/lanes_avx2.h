/* Lanes of AVX2: four at a time. kernel_lanes.h describes the operations. The
 * implementations for AVX-512, for AVX2 and in plain C must return the same bits. */
#pragma once

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

#include "kernel/floats_avx.h"
#include "window/wedges.h"

#define LANES            4
#define KERNEL(x)        gd__##x##_avx2
#define KERNEL_LINEAR(x) gd__##x##_avx2_linear

typedef __m256d lanes;
typedef __m256d mask;
typedef __m128i ids;

/* For each set of lanes: the permutation of half lanes (32 bits) that moves these lanes to the
 * front. */
#define HALVES(a, b, c, d)                                                                         \
    {                                                                                              \
        2 * a, 2 * a + 1, 2 * b, 2 * b + 1, 2 * c, 2 * c + 1, 2 * d, 2 * d + 1                     \
    }
static const uint32_t chosen_halves[16][8] __attribute__((aligned(32))) = {
    HALVES(0, 1, 2, 3), HALVES(0, 1, 2, 3), HALVES(1, 0, 2, 3), HALVES(0, 1, 2, 3),
    HALVES(2, 0, 1, 3), HALVES(0, 2, 1, 3), HALVES(1, 2, 0, 3), HALVES(0, 1, 2, 3),
    HALVES(3, 0, 1, 2), HALVES(0, 3, 1, 2), HALVES(1, 3, 0, 2), HALVES(0, 1, 3, 2),
    HALVES(2, 3, 0, 1), HALVES(0, 2, 3, 1), HALVES(1, 2, 3, 0), HALVES(0, 1, 2, 3)};
#undef HALVES
static const uint32_t chosen_ids[16][4] __attribute__((aligned(16))) = {
    {0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 1, 3},
    {1, 2, 0, 3}, {0, 1, 2, 3}, {3, 0, 1, 2}, {0, 3, 1, 2}, {1, 3, 0, 2}, {0, 1, 3, 2},
    {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 3, 0}, {0, 1, 2, 3}};
static const int64_t lane_bit[4] __attribute__((aligned(32))) = {1, 2, 4, 8};

static inline lanes all(double a)
{
    return _mm256_set1_pd(a);
}
static inline lanes load(const double *p)
{
    return _mm256_loadu_pd(p);
}
static inline void store(double *p, lanes a)
{
    _mm256_storeu_pd(p, a);
}
static inline mask mask_of(uint32_t set)
{
    __m256i bit = _mm256_load_si256((const void *)lane_bit);
    return _mm256_castsi256_pd(
        _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(set), bit), bit));
}
static inline mask first_lanes(uint32_t count)
{
    /* a comparison, because a branch would be mispredicted half of the time */
    const __m256i place = _mm256_set_epi64x(3, 2, 1, 0);
    return _mm256_castsi256_pd(_mm256_cmpgt_epi64(_mm256_set1_epi64x(count), place));
}
static inline lanes root(lanes a)
{
    return _mm256_sqrt_pd(a);
}
static inline lanes magnitude(lanes a)
{
    return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
}
static inline lanes greater(lanes a, lanes b)
{
    return _mm256_max_pd(a, b);
}
static inline lanes lesser(lanes a, lanes b)
{
    return _mm256_min_pd(a, b);
}
static inline lanes pick(mask m, lanes yes, lanes no)
{
    return _mm256_blendv_pd(no, yes, m);
}

static inline mask lt(lanes a, lanes b)
{
    return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}
static inline mask le(lanes a, lanes b)
{
    return _mm256_cmp_pd(a, b, _CMP_LE_OQ);
}
static inline mask eq(lanes a, lanes b)
{
    return _mm256_cmp_pd(a, b, _CMP_EQ_OQ);
}
static inline mask both(mask a, mask b)
{
    return _mm256_and_pd(a, b);
}
static inline mask either(mask a, mask b)
{
    return _mm256_or_pd(a, b);
}
static inline mask except(mask a, mask b)
{
    return _mm256_andnot_pd(b, a);
}
static inline uint32_t bits(mask m)
{
    return (uint32_t)_mm256_movemask_pd(m);
}

static inline lanes permuted(lanes a, const uint32_t *halves)
{
    __m256i order = _mm256_load_si256((const void *)halves);
    return _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(a), order));
}
static inline lanes compress(mask m, lanes a)
{
    return permuted(a, chosen_halves[bits(m)]);
}
static inline lanes after(double first, lanes a)
{
    return _mm256_blend_pd(_mm256_permute4x64_pd(a, 0x90), all(first), 1);
}
static inline lanes ahead(lanes a)
{
    return _mm256_permute4x64_pd(a, 0x39);
}
static inline mask mask_ahead(mask m)
{
    return _mm256_blend_pd(ahead(m), _mm256_setzero_pd(), 8);
}
static inline double last_of(lanes a, uint32_t count)
{
    return _mm256_cvtsd_f64(permuted(a, chosen_halves[1u << (count - 1)]));
}
static inline double first_of(lanes a)
{
    return _mm256_cvtsd_f64(a);
}
static inline lanes reversed(lanes a)
{
    return _mm256_permute4x64_pd(a, 0x1b);
}

static inline ids ids_permuted(ids a, const uint32_t *order)
{
    return _mm_castps_si128(
        _mm_permutevar_ps(_mm_castsi128_ps(a), _mm_load_si128((const void *)order)));
}
static inline ids ids_all(uint32_t a)
{
    return _mm_set1_epi32((int)a);
}
static inline ids ids_load(const uint32_t *p)
{
    return _mm_loadu_si128((const void *)p);
}
static inline void ids_store(uint32_t *p, ids a)
{
    _mm_storeu_si128((void *)p, a);
}
static inline mask ids_eq(ids a, ids b)
{
    return _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm_cmpeq_epi32(a, b)));
}
/* Returns the highest bit of each number. */
static inline mask ids_top(ids a)
{
    return _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm_srai_epi32(a, 31)));
}
static inline ids ids_compress(mask m, ids a)
{
    return ids_permuted(a, chosen_ids[bits(m)]);
}
static inline ids ids_after(uint32_t first, ids a)
{
    return _mm_blend_epi32(_mm_shuffle_epi32(a, 0x90), ids_all(first), 1);
}
static inline uint32_t ids_last_of(ids a, uint32_t count)
{
    return (uint32_t)_mm_cvtsi128_si32(ids_permuted(a, chosen_ids[1u << (count - 1)]));
}
static inline ids ids_reversed(ids a)
{
    return _mm_shuffle_epi32(a, 0x1b);
}

static inline void store_starts(uint32_t *p, lanes start)
{
    /* if this is added to a whole number below 2^32, the low half of the double is that number */
    const double two52 = 4503599627370496.0;
    __m256d whole = _mm256_round_pd(start, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC);
    __m256i low = _mm256_castpd_si256(_mm256_add_pd(whole, _mm256_set1_pd(two52)));
    __m256i order = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    _mm_storeu_si128((void *)p, _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(low, order)));
}

static inline double least_of(lanes a)
{
    __m128d half = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_min_sd(half, _mm_unpackhi_pd(half, half)));
}
static inline double most_of(lanes a)
{
    __m128d half = _mm_max_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_max_sd(half, _mm_unpackhi_pd(half, half)));
}

/* Returns the lower halves of 64-bit integers. */
static inline ids ids_narrow(__m256i a)
{
    __m256i order = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    return _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(a, order));
}

static inline void store_doubles(gd__chunk_double *p, lanes a)
{
    _mm256_storeu_si256((void *)p, _mm256_castpd_si256(a));
}
static inline void store_words(gd__chunk_word *p, __m256i a)
{
    _mm256_storeu_si256((void *)p, a);
}

struct packed {
    __m256i word, y;
    ids source;
};

static inline struct packed packed(lanes x, lanes y, ids source)
{
    __m256i y_bits = _mm256_castpd_si256(y),
            below =
                _mm256_cvtepu32_epi64(_mm_and_si128(source, _mm_set1_epi32(GD__WEDGE_LOW_MASK))),
            word = _mm256_or_si256(_mm256_slli_epi64(_mm256_castpd_si256(x), GD__WEDGE_X_SHIFT),
                                   _mm256_slli_epi64(below, GD__WEDGE_Y_SHIFT));
    word = _mm256_or_si256(word, _mm256_and_si256(y_bits, _mm256_set1_epi64x(3)));
    return (struct packed){word, y_bits, source};
}

static inline void store_rest(const struct gd__wedges *to, uint32_t at, const struct packed *p)
{
    ids above = _mm_srli_epi32(p->source, GD__WEDGE_LOW_SHIFT),
        middle = _mm_and_si128(ids_narrow(_mm256_srli_epi64(p->y, GD__WEDGE_Y_SHIFT)),
                               _mm_set1_epi32(0xffff));
    ids_store(to->high + at, ids_narrow(_mm256_srli_epi64(p->y, GD__WEDGE_HIGH_SHIFT)));
    _mm_storel_epi64((void *)(to->middle + at), _mm_packus_epi32(middle, middle));
    if (to->form == GD__WEDGE_20)
        _mm_storeu_si32((uint8_t *)to->low + at,
                        _mm_shuffle_epi8(above, _mm_set1_epi32(0x0c080400)));
    else
        _mm_storel_epi64((void *)((uint16_t *)to->low + at), _mm_packus_epi32(above, above));
}
