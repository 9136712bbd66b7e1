#if defined(__x86_64__)
#include "kernel/lanes_avx512.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return _mm512_maskz_loadu_pd(first_lanes(count), p);
}

static inline lanes starts_first(const uint64_t *p, uint32_t count)
{
    return _mm512_cvtepu32_pd(
        _mm512_cvtepi64_epi32(_mm512_maskz_loadu_epi64(first_lanes(count), p)));
}

static inline ids sources_first(const uint64_t *p, uint32_t count)
{
    return _mm512_cvtepi64_epi32(
        _mm512_srli_epi64(_mm512_maskz_loadu_epi64(first_lanes(count), p), 32));
}

static inline mask ids_below(ids a, uint32_t limit)
{
    return _mm256_cmplt_epu32_mask(a, _mm256_set1_epi32((int)limit));
}

static inline ids ids_scaled(ids a, uint32_t from, uint32_t by)
{
    return _mm256_mullo_epi32(_mm256_sub_epi32(a, _mm256_set1_epi32((int)from)),
                              _mm256_set1_epi32((int)by));
}

static inline lanes gather(mask m, const double *from, ids at)
{
    return _mm512_mask_i32gather_pd(_mm512_setzero_pd(), m, at, from, 8);
}

static inline double least_of(lanes a)
{
    return _mm512_reduce_min_pd(a);
}

static inline lanes ordinals(void)
{
    return _mm512_setr_pd(0, 1, 2, 3, 4, 5, 6, 7);
}

#include "field/wedge_view_lanes.h"

#endif
