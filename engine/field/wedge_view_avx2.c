#if defined(__x86_64__)
#include "kernel/lanes_avx2.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return _mm256_maskload_pd(p, _mm256_castpd_si256(first_lanes(count)));
}

static inline __m256i words_first(const uint64_t *p, uint32_t count)
{
    return _mm256_maskload_epi64((const long long *)p, _mm256_castpd_si256(first_lanes(count)));
}

static inline lanes starts_first(const uint64_t *p, uint32_t count)
{
    /* a double whose low half is a whole number below 2^32, once it is taken off again */
    const double two52 = 4503599627370496.0;
    __m256i whole =
        _mm256_blend_epi32(words_first(p, count), _mm256_castpd_si256(all(two52)), 0xaa);
    return _mm256_castsi256_pd(whole) - all(two52);
}

static inline ids sources_first(const uint64_t *p, uint32_t count)
{
    __m256i high = _mm256_permutevar8x32_epi32(words_first(p, count),
                                               _mm256_setr_epi32(1, 3, 5, 7, 1, 3, 5, 7));
    return _mm256_castsi256_si128(high);
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
