#if defined(__x86_64__)
#include "kernel/lanes_avx2.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return _mm256_maskload_pd(p, _mm256_castpd_si256(first_lanes(count)));
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    /* 2^52 + n has the integer n < 2^32 in its low half; subtracting 2^52 converts n to a double */
    const double two52 = 4503599627370496.0;
    __m256i whole =
        _mm256_or_si256(_mm256_cvtepu32_epi64(ids_load(p)), _mm256_castpd_si256(all(two52)));
    (void)count; /* reads beyond the array are safe, because further arrays of the chunk follow */
    return _mm256_castsi256_pd(whole) - all(two52);
}

static inline ids highs_first(const struct gd__wedges *wedges, uint32_t at, uint32_t count)
{
    (void)count;
    if (wedges->form == GD__WEDGE_16)
        return _mm_slli_epi32(_mm_cvtepu8_epi32(_mm_loadu_si32((uint8_t *)wedges->high + at)), 8);
    if (wedges->form == GD__WEDGE_24)
        return _mm_slli_epi32(
            _mm_cvtepu16_epi32(_mm_loadl_epi64((const void *)((uint16_t *)wedges->high + at))), 8);
    return ids_load((uint32_t *)wedges->high + at);
}

static inline ids sources_of(ids high, lanes x, lanes y, uint64_t nibble)
{
    __m256i keep = _mm256_set1_epi64x((long long)nibble),
            low =
                _mm256_srli_epi64(_mm256_and_si256(_mm256_castpd_si256(x), keep), GD__WEDGE_SHIFT),
            next = _mm256_srli_epi64(_mm256_and_si256(_mm256_castpd_si256(y), keep),
                                     GD__WEDGE_SHIFT - 4),
            order = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    return _mm_or_si128(high, _mm256_castsi256_si128(
                                  _mm256_permutevar8x32_epi32(_mm256_or_si256(low, next), order)));
}

static inline lanes without(lanes a, uint64_t mask_bits)
{
    return _mm256_andnot_pd(_mm256_castsi256_pd(_mm256_set1_epi64x((long long)mask_bits)), a);
}

static inline mask ids_below(ids a, uint32_t limit)
{
    __m128i least = _mm_max_epu32(a, _mm_set1_epi32((int)limit));
    return except(_mm256_castsi256_pd(_mm256_set1_epi64x(-1)), ids_eq(least, a));
}

static inline ids ids_scaled(ids a, uint32_t from, uint32_t by)
{
    return _mm_mullo_epi32(_mm_sub_epi32(a, _mm_set1_epi32((int)from)), _mm_set1_epi32((int)by));
}

static inline lanes gather(mask m, const double *from, ids at)
{
    return _mm256_mask_i32gather_pd(_mm256_setzero_pd(), from, at, m, 8);
}

static inline double least_of(lanes a)
{
    __m128d half = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_min_sd(half, _mm_unpackhi_pd(half, half)));
}

static inline lanes ordinals(void)
{
    return _mm256_setr_pd(0, 1, 2, 3);
}

#include "field/wedge_view_lanes.h"

#endif
