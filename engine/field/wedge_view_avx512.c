#if defined(__x86_64__)
#include "kernel/lanes_avx512.h"

static inline lanes load_first(const gd__chunk_double *p, uint32_t count)
{
    return _mm512_maskz_loadu_pd(first_lanes(count), p);
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    return _mm512_cvtepu32_pd(_mm256_maskz_loadu_epi32(first_lanes(count), p));
}

static inline ids ids_first(const uint32_t *p, uint32_t count)
{
    return _mm256_maskz_loadu_epi32(first_lanes(count), p);
}

/* Reads up to GD__CHUNK_SLACK bytes behind the chunk. */
static inline ids load_packed(const struct gd__wedges *wedges, uint32_t at,
                              const struct gd__wedge_zero *zero, lanes *x, lanes *y)
{
    mask here = first_lanes(wedges->count - at);
    const char *low = wedges->low;
    __m512i word = _mm512_maskz_loadu_epi64(here, wedges->word + at),
            high = _mm512_cvtepu32_epi64(_mm256_maskz_loadu_epi32(here, wedges->high + at)),
            middle = _mm512_cvtepu16_epi64(_mm_loadu_si128((const void *)(wedges->middle + at)));
    __m512i rest = _mm512_or_si512(_mm512_set1_epi64((long long)zero->y_bits),
                                   _mm512_and_si512(word, _mm512_set1_epi64(3))),
            y_bits = _mm512_or_si512(_mm512_slli_epi64(high, GD__WEDGE_HIGH_SHIFT),
                                     _mm512_slli_epi64(middle, GD__WEDGE_Y_SHIFT));
    *x = _mm512_castsi512_pd(_mm512_or_si512(_mm512_set1_epi64((long long)zero->x_bits),
                                             _mm512_srli_epi64(word, GD__WEDGE_X_SHIFT)));
    *y = _mm512_castsi512_pd(_mm512_or_si512(y_bits, rest));
    ids above = wedges->form == GD__WEDGE_20
                    ? _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)(low + at)))
                    : _mm256_cvtepu16_epi32(_mm_loadu_si128((const void *)(low + 2 * (size_t)at))),
        below = _mm512_cvtepi64_epi32(_mm512_srli_epi64(word, GD__WEDGE_Y_SHIFT));
    return _mm256_or_si256(_mm256_slli_epi32(above, GD__WEDGE_LOW_SHIFT),
                           _mm256_and_si256(below, _mm256_set1_epi32(GD__WEDGE_LOW_MASK)));
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

static inline lanes ordinals(void)
{
    return _mm512_setr_pd(0, 1, 2, 3, 4, 5, 6, 7);
}

#include "field/wedge_view_lanes.h"

#endif
