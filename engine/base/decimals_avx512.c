#if defined(__x86_64__)
#include <immintrin.h>

#include "base/decimals.h"

#define LANES     8
#define ALL_LANES 255u
#define KERNEL(x) gd__##x##_avx512

typedef __m512i lanes;
typedef __mmask8 choice;

#define left(a, bits)    _mm512_slli_epi64(a, bits)
#define right(a, bits)   _mm512_srli_epi64(a, bits)
#define left32(a, bits)  _mm512_slli_epi32(a, bits)
#define left16(a, bits)  _mm512_slli_epi16(a, bits)
#define right16(a, bits) _mm512_srli_epi16(a, bits)

static inline lanes all(int64_t a)
{
    return _mm512_set1_epi64(a);
}
static inline lanes all32(int a)
{
    return _mm512_set1_epi32(a);
}
static inline lanes all16(short a)
{
    return _mm512_set1_epi16(a);
}
static inline lanes add(lanes a, lanes b)
{
    return _mm512_add_epi64(a, b);
}
static inline lanes add16(lanes a, lanes b)
{
    return _mm512_add_epi16(a, b);
}
static inline lanes subtract(lanes a, lanes b)
{
    return _mm512_sub_epi64(a, b);
}
static inline lanes subtract16(lanes a, lanes b)
{
    return _mm512_sub_epi16(a, b);
}
static inline lanes times(lanes a, lanes b)
{
    return _mm512_mul_epu32(a, b);
}
static inline lanes times16(lanes a, lanes b)
{
    return _mm512_mullo_epi16(a, b);
}
static inline lanes times16_high(lanes a, lanes b)
{
    return _mm512_mulhi_epu16(a, b);
}
static inline lanes both(lanes a, lanes b)
{
    return _mm512_and_si512(a, b);
}
static inline choice below(lanes a, lanes b)
{
    return _mm512_cmplt_epu64_mask(a, b);
}
static inline choice either(choice a, choice b)
{
    return a | b;
}
static inline choice unless(choice a, choice b)
{
    return (choice)(a & ~b);
}
static inline lanes chosen(lanes a, choice here)
{
    return _mm512_maskz_mov_epi64(here, a);
}
static inline lanes unchosen(lanes a, choice elsewhere)
{
    return _mm512_maskz_mov_epi64((choice)~elsewhere, a);
}
static inline lanes pick(choice here, lanes yes, lanes no)
{
    return _mm512_mask_blend_epi64(here, no, yes);
}
static inline uint32_t lanes_of(choice a)
{
    return a;
}
static inline lanes evens(lanes a, lanes b)
{
    return _mm512_unpacklo_epi64(a, b);
}
static inline lanes odds(lanes a, lanes b)
{
    return _mm512_unpackhi_epi64(a, b);
}
static inline void store(uint64_t *to, lanes a)
{
    _mm512_storeu_si512(to, a);
}

static inline lanes load_first(const double *from, uint32_t count)
{
    choice here = count < LANES ? (choice)((1u << count) - 1) : (choice)ALL_LANES;
    return _mm512_castpd_si512(_mm512_maskz_loadu_pd(here, from));
}

static inline __m128i scale_at(uint64_t index)
{
    return _mm_loadu_si128((const __m128i *)&gd__decimal_scales.of[index]);
}

/* Returns the scales of every second index. */
static inline lanes four_scales(const uint64_t *at)
{
    lanes scales = _mm512_castsi128_si512(scale_at(at[0]));
    scales = _mm512_inserti64x2(scales, scale_at(at[2]), 1);
    scales = _mm512_inserti64x2(scales, scale_at(at[4]), 2);
    return _mm512_inserti64x2(scales, scale_at(at[6]), 3);
}

/* Loads whole entries, because a gather is slower. */
static inline void load_scales(lanes index, lanes *high, lanes *low)
{
    uint64_t at[LANES];
    store(at, index);
    lanes even = four_scales(at), odd = four_scales(at + 1);
    *high = evens(even, odd);
    *low = odds(even, odd);
}

static inline void put_every_second(lanes digits, struct gd__decimals *out, uint32_t at)
{
    lanes text = _mm512_add_epi8(digits, _mm512_set1_epi8('0'));
    uint64_t counting = _mm512_test_epi8_mask(digits, digits);
    _mm_storeu_si128((__m128i *)out->digits[at], _mm512_castsi512_si128(text));
    _mm_storeu_si128((__m128i *)out->digits[at + 2], _mm512_extracti64x2_epi64(text, 1));
    _mm_storeu_si128((__m128i *)out->digits[at + 4], _mm512_extracti64x2_epi64(text, 2));
    _mm_storeu_si128((__m128i *)out->digits[at + 6], _mm512_extracti64x2_epi64(text, 3));
    for (int i = 0; i < 4; i++) out->counting[at + 2 * i] = (uint16_t)(counting >> 16 * i);
}

static inline void put_rows(lanes even, lanes odd, struct gd__decimals *out, uint32_t at)
{
    put_every_second(even, out, at);
    put_every_second(odd, out, at + 1);
}

#include "base/decimals_lanes.h"
#endif
