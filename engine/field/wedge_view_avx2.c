#if defined(__x86_64__)
#include "kernel/lanes_avx2.h"

static inline lanes load_first(const gd__chunk_double *p, uint32_t count)
{
    return _mm256_maskload_pd((const void *)p, _mm256_castpd_si256(first_lanes(count)));
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    /* 2^52 + n has the integer n < 2^32 in its low half; subtracting 2^52 converts n to a double */
    const double two52 = 4503599627370496.0;
    __m256i whole =
        _mm256_or_si256(_mm256_cvtepu32_epi64(ids_load(p)), _mm256_castpd_si256(all(two52)));
    (void)count; /* reads up to GD__CHUNK_SLACK bytes behind the chunk */
    return _mm256_castsi256_pd(whole) - all(two52);
}

static inline ids ids_first(const uint32_t *p, uint32_t count)
{
    (void)count;
    return ids_load(p);
}

/* Reads up to GD__CHUNK_SLACK bytes behind the chunk. */
static inline ids load_packed(const struct gd__wedges *wedges, uint32_t at,
                              const struct gd__wedge_zero *zero, lanes *x, lanes *y)
{
    const char *low = wedges->low;
    __m256i word = _mm256_loadu_si256((const void *)(wedges->word + at)),
            high = _mm256_cvtepu32_epi64(ids_load(wedges->high + at)),
            middle = _mm256_cvtepu16_epi64(_mm_loadl_epi64((const void *)(wedges->middle + at)));
    __m256i rest = _mm256_or_si256(_mm256_set1_epi64x((long long)zero->y_bits),
                                   _mm256_and_si256(word, _mm256_set1_epi64x(3))),
            y_bits = _mm256_or_si256(_mm256_slli_epi64(high, GD__WEDGE_HIGH_SHIFT),
                                     _mm256_slli_epi64(middle, GD__WEDGE_Y_SHIFT));
    *x = _mm256_castsi256_pd(_mm256_or_si256(_mm256_set1_epi64x((long long)zero->x_bits),
                                             _mm256_srli_epi64(word, GD__WEDGE_X_SHIFT)));
    *y = _mm256_castsi256_pd(_mm256_or_si256(y_bits, rest));
    ids above = wedges->form == GD__WEDGE_20
                    ? _mm_cvtepu8_epi32(_mm_loadu_si32(low + at))
                    : _mm_cvtepu16_epi32(_mm_loadl_epi64((const void *)(low + 2 * (size_t)at))),
        below = ids_narrow(_mm256_srli_epi64(word, GD__WEDGE_Y_SHIFT));
    return _mm_or_si128(_mm_slli_epi32(above, GD__WEDGE_LOW_SHIFT),
                        _mm_and_si128(below, _mm_set1_epi32(GD__WEDGE_LOW_MASK)));
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

static inline lanes ordinals(void)
{
    return _mm256_setr_pd(0, 1, 2, 3);
}

#include "field/wedge_view_lanes.h"

#endif
