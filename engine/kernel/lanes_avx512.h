/* Lanes of AVX-512 (F, VL, DQ): eight at a time. kernel_lanes.h describes the operations. The three
 * sets of lanes must return the same bits. */
#pragma once

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

#include "kernel/floats_avx.h"
#include "window/wedges.h"

#define LANES            8
#define KERNEL(x)        gd__##x##_avx512
#define KERNEL_LINEAR(x) gd__##x##_avx512_linear

typedef __m512d lanes;
typedef __mmask8 mask;
typedef __m256i ids;

static inline lanes all(double a)
{
    return _mm512_set1_pd(a);
}
static inline lanes load(const double *p)
{
    return _mm512_loadu_pd(p);
}
static inline void store(double *p, lanes a)
{
    _mm512_storeu_pd(p, a);
}
static inline mask first_lanes(uint32_t count)
{
    /* a comparison, because a branch would be mispredicted half of the time */
    const __m256i place = _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    return _mm256_cmpgt_epu32_mask(_mm256_set1_epi32((int)count), place);
}
static inline lanes root(lanes a)
{
    return _mm512_sqrt_pd(a);
}
static inline lanes magnitude(lanes a)
{
    return _mm512_abs_pd(a);
}
static inline lanes greater(lanes a, lanes b)
{
    return _mm512_max_pd(a, b);
}
static inline lanes lesser(lanes a, lanes b)
{
    return _mm512_min_pd(a, b);
}
static inline lanes pick(mask m, lanes yes, lanes no)
{
    return _mm512_mask_blend_pd(m, no, yes);
}

static inline mask lt(lanes a, lanes b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
static inline mask le(lanes a, lanes b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}
static inline mask eq(lanes a, lanes b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ);
}
static inline mask both(mask a, mask b)
{
    return a & b;
}
static inline mask either(mask a, mask b)
{
    return a | b;
}
static inline mask except(mask a, mask b)
{
    return a & (mask)~b;
}
static inline uint32_t bits(mask m)
{
    return m;
}
static inline mask mask_of(uint32_t set)
{
    return (mask)set;
}

static inline lanes compress(mask m, lanes a)
{
    return _mm512_maskz_compress_pd(m, a);
}
static inline lanes after(double first, lanes a)
{
    return _mm512_castsi512_pd(
        _mm512_alignr_epi64(_mm512_castpd_si512(a), _mm512_castpd_si512(all(first)), 7));
}
static inline lanes ahead(lanes a)
{
    return _mm512_castsi512_pd(
        _mm512_alignr_epi64(_mm512_castpd_si512(a), _mm512_castpd_si512(a), 1));
}
static inline mask mask_ahead(mask m)
{
    return m >> 1;
}
static inline double last_of(lanes a, uint32_t count)
{
    return _mm512_cvtsd_f64(_mm512_permutexvar_pd(_mm512_set1_epi64(count - 1), a));
}
static inline double first_of(lanes a)
{
    return _mm512_cvtsd_f64(a);
}
static inline lanes reversed(lanes a)
{
    return _mm512_permutexvar_pd(_mm512_set_epi64(0, 1, 2, 3, 4, 5, 6, 7), a);
}

static inline ids ids_all(uint32_t a)
{
    return _mm256_set1_epi32((int)a);
}
static inline ids ids_load(const uint32_t *p)
{
    return _mm256_loadu_si256((const void *)p);
}
static inline void ids_store(uint32_t *p, ids a)
{
    _mm256_storeu_si256((void *)p, a);
}
static inline mask ids_eq(ids a, ids b)
{
    return _mm256_cmpeq_epi32_mask(a, b);
}
/* Returns the highest bit of each number. */
static inline mask ids_top(ids a)
{
    return _mm256_movepi32_mask(a);
}
static inline ids ids_compress(mask m, ids a)
{
    return _mm256_maskz_compress_epi32(m, a);
}
static inline ids ids_after(uint32_t first, ids a)
{
    return _mm256_alignr_epi32(a, ids_all(first), 7);
}
static inline uint32_t ids_last_of(ids a, uint32_t count)
{
    return (uint32_t)_mm256_cvtsi256_si32(
        _mm256_permutexvar_epi32(_mm256_set1_epi32((int)count - 1), a));
}
static inline ids ids_reversed(ids a)
{
    return _mm256_permutexvar_epi32(_mm256_set_epi32(0, 1, 2, 3, 4, 5, 6, 7), a);
}

static inline void store_starts(uint32_t *p, lanes start)
{
    _mm256_storeu_si256((void *)p, _mm512_cvttpd_epu32(start));
}

static inline double least_of(lanes a)
{
    return _mm512_reduce_min_pd(a);
}
static inline double most_of(lanes a)
{
    return _mm512_reduce_max_pd(a);
}

static inline void store_doubles(gd__chunk_double *p, lanes a)
{
    _mm512_storeu_pd(p, a);
}
static inline void store_words(gd__chunk_word *p, __m512i a)
{
    _mm512_storeu_si512(p, a);
}

struct packed {
    __m512i word, y;
    ids source;
};

static inline struct packed packed(lanes x, lanes y, ids source)
{
    __m512i y_bits = _mm512_castpd_si512(y),
            below = _mm512_cvtepu32_epi64(
                _mm256_and_si256(source, _mm256_set1_epi32(GD__WEDGE_LOW_MASK))),
            word = _mm512_or_si512(_mm512_slli_epi64(_mm512_castpd_si512(x), GD__WEDGE_X_SHIFT),
                                   _mm512_slli_epi64(below, GD__WEDGE_Y_SHIFT));
    word = _mm512_or_si512(word, _mm512_and_si512(y_bits, _mm512_set1_epi64(3)));
    return (struct packed){word, y_bits, source};
}

static inline void store_rest(const struct gd__wedges *to, uint32_t at, const struct packed *p)
{
    ids above = _mm256_srli_epi32(p->source, GD__WEDGE_LOW_SHIFT);
    _mm256_storeu_si256((void *)(to->high + at),
                        _mm512_cvtepi64_epi32(_mm512_srli_epi64(p->y, GD__WEDGE_HIGH_SHIFT)));
    _mm_storeu_si128((void *)(to->middle + at),
                     _mm512_cvtepi64_epi16(_mm512_srli_epi64(p->y, GD__WEDGE_Y_SHIFT)));
    if (to->form == GD__WEDGE_20)
        _mm_storel_epi64((void *)((uint8_t *)to->low + at), _mm256_cvtepi32_epi8(above));
    else
        _mm_storeu_si128((void *)((uint16_t *)to->low + at), _mm256_cvtepi32_epi16(above));
}
