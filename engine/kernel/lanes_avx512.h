/* Lanes of AVX-512 (F, VL, DQ): eight at a time. kernel_lanes.h describes the operations. The three
 * sets of lanes must return the same bits. */
#ifndef GD_KERNEL_LANES_H
#define GD_KERNEL_LANES_H

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
    /* by comparison: a branch would be mispredicted half of the time */
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

static inline ids ids_pick(mask m, ids a)
{
    return _mm256_maskz_mov_epi32(m, a);
}

static inline void store_highs(const struct gd__wedges *to, uint32_t at, ids source)
{
    ids high = _mm256_srli_epi32(source, 8);
    if (to->form == GD__WEDGE_16)
        _mm_storel_epi64((void *)((uint8_t *)to->high + at), _mm256_cvtepi32_epi8(high));
    else if (to->form == GD__WEDGE_24)
        _mm_storeu_si128((void *)((uint16_t *)to->high + at), _mm256_cvtepi32_epi16(high));
    else
        _mm256_storeu_si256((void *)((uint32_t *)to->high + at), source);
}

static inline lanes packed(lanes a, ids source, int shift, uint64_t nibble)
{
    __m512i bits =
        _mm512_and_si512(_mm512_slli_epi64(_mm512_cvtepu32_epi64(source), (unsigned)shift),
                         _mm512_set1_epi64((long long)nibble));
    return _mm512_castsi512_pd(_mm512_or_si512(_mm512_castpd_si512(a), bits));
}

#endif
