#if defined(__x86_64__)
#include "kernel/lanes_avx512.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return _mm512_maskz_loadu_pd(first_lanes(count), p);
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    return _mm512_cvtepu32_pd(_mm256_maskz_loadu_epi32(first_lanes(count), p));
}

static inline ids highs_first(const struct gd__wedges *wedges, uint32_t at, uint32_t count)
{
    if (wedges->form == GD__WEDGE_16)
        return _mm256_slli_epi32(
            _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)((uint8_t *)wedges->high + at))), 8);
    if (wedges->form == GD__WEDGE_24)
        return _mm256_slli_epi32(
            _mm256_cvtepu16_epi32(_mm_loadu_si128((const void *)((uint16_t *)wedges->high + at))),
            8);
    return _mm256_maskz_loadu_epi32(first_lanes(count), (uint32_t *)wedges->high + at);
}

static inline ids sources_of(ids high, lanes x, lanes y, uint64_t nibble)
{
    __m512i keep = _mm512_set1_epi64((long long)nibble),
            low =
                _mm512_srli_epi64(_mm512_and_si512(_mm512_castpd_si512(x), keep), GD__WEDGE_SHIFT),
            next = _mm512_srli_epi64(_mm512_and_si512(_mm512_castpd_si512(y), keep),
                                     GD__WEDGE_SHIFT - 4);
    return _mm256_or_si256(high, _mm512_cvtepi64_epi32(_mm512_or_si512(low, next)));
}

static inline lanes without(lanes a, uint64_t mask_bits)
{
    __m512i drop = _mm512_set1_epi64((long long)mask_bits);
    return _mm512_castsi512_pd(_mm512_andnot_si512(drop, _mm512_castpd_si512(a)));
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
