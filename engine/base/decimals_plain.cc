#include "base/decimals.h"

#include <cmath>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/shortest.h"

#ifdef __SSE2__

/* Writes the digits of a number below 10^16 with leading zeros. Returns a mask of the digits that
 * are not 0. Splits halves, quarters and bytes within one register, as in decimals_avx2.c. */
static unsigned put16(char *to, std::uint64_t value)
{
    const __m128i halves =
        _mm_set_epi64x((std::int64_t)(value % 100000000), (std::int64_t)(value / 100000000));
    /* divides by 10000 */
    const __m128i upper4 = _mm_srli_epi64(_mm_mul_epu32(halves, _mm_set1_epi64x(3518437209)), 45);
    const __m128i lower4 = _mm_sub_epi32(halves, _mm_mul_epu32(upper4, _mm_set1_epi64x(10000)));
    const __m128i fours = _mm_or_si128(upper4, _mm_slli_epi64(lower4, 32));
    /* divides by 100 */
    const __m128i upper2 = _mm_srli_epi16(_mm_mulhi_epu16(fours, _mm_set1_epi32(5243)), 3);
    const __m128i lower2 = _mm_sub_epi16(fours, _mm_mullo_epi16(upper2, _mm_set1_epi32(100)));
    const __m128i twos = _mm_or_si128(upper2, _mm_slli_epi32(lower2, 16));
    const __m128i upper = _mm_mulhi_epu16(twos, _mm_set1_epi16(6554)); /* divides by 10 */
    const __m128i lower = _mm_sub_epi16(twos, _mm_mullo_epi16(upper, _mm_set1_epi16(10)));
    const __m128i digits = _mm_or_si128(upper, _mm_slli_epi16(lower, 8));
    _mm_storeu_si128((__m128i *)to, _mm_add_epi8(digits, _mm_set1_epi8('0')));
    return (unsigned)_mm_movemask_epi8(_mm_cmpgt_epi8(digits, _mm_setzero_si128()));
}

#else

static unsigned put16(char *to, std::uint64_t value)
{
    unsigned counting = 0;
    for (int i = 15; i >= 0; i--, value /= 10) {
        to[i] = (char)('0' + value % 10);
        counting |= (unsigned)(to[i] != '0') << i;
    }
    return counting;
}

#endif

void gd__decimals_set(struct gd__decimals *decimals, std::uint32_t i, std::uint64_t digits,
                      int point, bool is_negative)
{
    const std::uint64_t e16 = 10000000000000000, first = digits / e16;
    decimals->head[i] = gd__decimal_head((char)('0' + first), is_negative, point);
    decimals->counting[i] = (std::uint16_t)put16(decimals->digits[i], digits - first * e16);
}

/* Converts in two passes, so that the processor works on several numbers at a time in each. */
std::uint32_t gd__decimals_plain(const double *values, std::uint32_t count,
                                 struct gd__decimals *out)
{
    gd::decimal found[GD__DECIMALS];
    std::uint32_t left_out = 0;
    for (std::uint32_t i = 0; i < count; i++) {
        const double magnitude = std::fabs(values[i]);
        const bool is_plain = magnitude >= 1e-6 && magnitude < 1e17;
        left_out |= std::uint32_t(!is_plain) << i;
        found[i] = is_plain ? gd::shortest(magnitude) : gd::decimal{0, GD__DECIMAL_LEAST};
    }
    for (std::uint32_t i = 0; i < count; i++)
        gd__decimals_set(out, i, found[i].digits, found[i].point, std::signbit(values[i]));
    return left_out;
}
