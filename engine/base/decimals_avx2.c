#if defined(__x86_64__)
#include <immintrin.h>

#include "base/decimals.h"

#define LANES     4
#define ALL_LANES 15u
#define KERNEL(x) gd__##x##_avx2

typedef __m256i lanes, choice;

#define left(a, bits)    _mm256_slli_epi64(a, bits)
#define right(a, bits)   _mm256_srli_epi64(a, bits)
#define left32(a, bits)  _mm256_slli_epi32(a, bits)
#define left16(a, bits)  _mm256_slli_epi16(a, bits)
#define right16(a, bits) _mm256_srli_epi16(a, bits)

static inline lanes all(int64_t a)
{
    return _mm256_set1_epi64x(a);
}
static inline lanes all32(int a)
{
    return _mm256_set1_epi32(a);
}
static inline lanes all16(short a)
{
    return _mm256_set1_epi16(a);
}
static inline lanes add(lanes a, lanes b)
{
    return _mm256_add_epi64(a, b);
}
static inline lanes add16(lanes a, lanes b)
{
    return _mm256_add_epi16(a, b);
}
static inline lanes subtract(lanes a, lanes b)
{
    return _mm256_sub_epi64(a, b);
}
static inline lanes subtract16(lanes a, lanes b)
{
    return _mm256_sub_epi16(a, b);
}
static inline lanes times(lanes a, lanes b)
{
    return _mm256_mul_epu32(a, b);
}
static inline lanes times16(lanes a, lanes b)
{
    return _mm256_mullo_epi16(a, b);
}
static inline lanes times16_high(lanes a, lanes b)
{
    return _mm256_mulhi_epu16(a, b);
}
static inline lanes both(lanes a, lanes b)
{
    return _mm256_and_si256(a, b);
}
static inline choice below(lanes a, lanes b)
{
    return _mm256_cmpgt_epi64(b, a);
}
static inline choice either(choice a, choice b)
{
    return _mm256_or_si256(a, b);
}
static inline choice unless(choice a, choice b)
{
    return _mm256_andnot_si256(b, a);
}
static inline lanes chosen(lanes a, choice here)
{
    return _mm256_and_si256(a, here);
}
static inline lanes unchosen(lanes a, choice elsewhere)
{
    return _mm256_andnot_si256(elsewhere, a);
}
static inline lanes pick(choice here, lanes yes, lanes no)
{
    return _mm256_blendv_epi8(no, yes, here);
}
static inline uint32_t lanes_of(choice a)
{
    return (uint32_t)_mm256_movemask_pd(_mm256_castsi256_pd(a));
}
static inline lanes evens(lanes a, lanes b)
{
    return _mm256_unpacklo_epi64(a, b);
}
static inline lanes odds(lanes a, lanes b)
{
    return _mm256_unpackhi_epi64(a, b);
}
static inline void store(uint64_t *to, lanes a)
{
    _mm256_storeu_si256((__m256i *)to, a);
}

static inline lanes load_first(const double *from, uint32_t count)
{
    lanes here = _mm256_cmpgt_epi64(all(count), _mm256_setr_epi64x(0, 1, 2, 3));
    return _mm256_castpd_si256(_mm256_maskload_pd(from, here));
}

static inline __m128i scale_at(uint64_t index)
{
    return _mm_loadu_si128((const __m128i *)&gd__decimal_scales.of[index]);
}

static inline lanes two_scales(uint64_t a, uint64_t b)
{
    return _mm256_inserti128_si256(_mm256_castsi128_si256(scale_at(a)), scale_at(b), 1);
}

/* Loads whole entries, because a gather is slower. */
static inline void load_scales(lanes index, lanes *high, lanes *low)
{
    uint64_t at[LANES];
    store(at, index);
    lanes even = two_scales(at[0], at[2]), odd = two_scales(at[1], at[3]);
    *high = evens(even, odd);
    *low = odds(even, odd);
}

static inline void put_every_second(lanes digits, struct gd__decimals *out, uint32_t at)
{
    lanes text = _mm256_add_epi8(digits, _mm256_set1_epi8('0'));
    uint32_t counting =
        (uint32_t)_mm256_movemask_epi8(_mm256_cmpgt_epi8(digits, _mm256_setzero_si256()));
    _mm_storeu_si128((__m128i *)out->digits[at], _mm256_castsi256_si128(text));
    _mm_storeu_si128((__m128i *)out->digits[at + 2], _mm256_extracti128_si256(text, 1));
    out->counting[at] = (uint16_t)counting;
    out->counting[at + 2] = (uint16_t)(counting >> 16);
}

static inline void put_rows(lanes even, lanes odd, struct gd__decimals *out, uint32_t at)
{
    put_every_second(even, out, at);
    put_every_second(odd, out, at + 1);
}

#include "base/decimals_lanes.h"
#endif
