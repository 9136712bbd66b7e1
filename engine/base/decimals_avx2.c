#if defined(__x86_64__)
#include <immintrin.h>

#include "base/decimals.h"

/* The algorithm is Dragonbox (J. Jeon, "Dragonbox: a new floating-point binary-to-decimal
 * conversion algorithm", 2022), with fractions instead of remainders. All reals in an interval
 * around a double round to it. In units of 10^k (decimals.h) the interval has a length of 0.1 to 1.
 * If the fraction of its upper end is less than its length, the whole part of the upper end is the
 * shortest decimal. Otherwise the shortest decimal is the multiple of 1/10 nearest to the
 * interval's middle. Fractions have 32 bits and are at most 5 units too small. If this precision is
 * not enough for a comparison, the kernel does not convert the number. This is the case for all
 * ties, and for about one other number in thirty million. Below a power of two, the interval
 * extends only half as far as assumed here. That changes no result for the 75 exponents of the
 * scales (test_decimals.c tests all). */

#define FRACTION_BITS 52
#define HALF          UINT64_C(0xffffffff) /* the lower half of a lane */
/* fractions that differ by at most this much are not compared */
#define MARGIN 8
/* the margin for tenths, whose error is ten times as large */
#define TENTHS_MARGIN 64

/* Four integers. In a mask, each lane has all bits set or none. */
typedef uint64_t lanes __attribute__((vector_size(32)));
typedef int64_t signed_lanes __attribute__((vector_size(32)));
enum { LANES = 4 };

static inline lanes all(uint64_t a)
{
    return (lanes){a, a, a, a};
}

/* Multiplies the lower halves of lanes. */
static inline lanes times(lanes a, lanes b)
{
    return (lanes)_mm256_mul_epu32((__m256i)a, (__m256i)b);
}

static inline lanes times_ten(lanes a)
{
    return (a << 3) + (a << 1);
}

/* Returns a mask of the lanes where a < b. Both are below 2^63. */
static inline lanes below(lanes a, lanes b)
{
    return (lanes)((signed_lanes)a < (signed_lanes)b);
}

/* Returns a mask of the lanes whose lower half, as a number modulo 2^32, differs from 0 by at most
 * `margin`. */
static inline lanes is_near_0(lanes a, uint64_t margin)
{
    return below((a + all(margin)) & all(HALF), all(2 * margin + 1));
}

static inline uint32_t lanes_of(lanes choice)
{
    return (uint32_t)_mm256_movemask_pd((__m256d)choice);
}

/* --- the decimal ------------------------------------------------------------------------------ */

/* The upper end of an interval, in units of 10^k. */
struct upper {
    lanes whole, fraction; /* `whole` has 54 bits, `fraction` 32 */
};

/* Multiplies x < 2^62 by a scale. The fraction may be a few units too small. */
static inline struct upper scale_up(lanes x, lanes high, lanes low)
{
    lanes x1 = x >> 32, high1 = high >> 32;
    lanes middle = times(x, high1) + (times(x, high) >> 32) + (times(x1, low) >> 32);
    middle += times(x1, high); /* the sum is below 2^63 */
    return (struct upper){times(x1, high1) + (middle >> 32), middle & all(HALF)};
}

/* The 16 or 17 digits as an integer, and the mask of the lanes that are not converted. */
struct found {
    lanes digits, is_left_out;
};

static inline struct found find_digits(struct upper upper, lanes width)
{
    lanes from_middle = upper.fraction - (width >> 1);
    lanes tenths = times(from_middle, all(10)) + all(UINT64_C(1) << 31);
    lanes is_whole = below(upper.fraction, width);
    lanes is_unclear =
        is_near_0(upper.fraction, MARGIN) | is_near_0(upper.fraction - width, MARGIN);
    return (struct found){times_ten(upper.whole) + ((tenths >> 32) & ~is_whole),
                          is_unclear | (is_near_0(tenths, TENTHS_MARGIN) & ~is_whole)};
}

/* --- text ------------------------------------------------------------------------------------- */

/* A number below 10^17, split into its first digit and two groups of eight. */
struct parts {
    lanes first, upper, lower;
};

static inline struct parts part(lanes digits)
{
    const lanes e8 = all(100000000);
    /* the quotient by 10^8, or one less */
    lanes quotient = times(digits >> 25, all(2882303761)) >> 33;
    lanes rest = digits - times(quotient, e8), is_less = below(all(99999999), rest);
    quotient -= is_less;
    lanes first = times(quotient, all(1441151881)) >> 57; /* divides by 10^8 */
    return (struct parts){first, quotient - times(first, e8), rest - (e8 & is_less)};
}

/* Returns the digits, one byte each, of two eight-digit numbers side by side. Splits them into
 * halves, quarters and bytes. */
static inline __m256i digits_of(lanes eights)
{
    lanes upper4 = times(eights, all(3518437209)) >> 45; /* divides by 10000 */
    lanes lower4 = eights - times(upper4, all(10000));
    __m256i fours = (__m256i)(upper4 + (lower4 << 32));
    /* divides by 100 */
    __m256i upper2 = _mm256_srli_epi16(_mm256_mulhi_epu16(fours, _mm256_set1_epi32(5243)), 3);
    __m256i lower2 = _mm256_sub_epi16(fours, _mm256_mullo_epi16(upper2, _mm256_set1_epi32(100)));
    __m256i twos = _mm256_or_si256(upper2, _mm256_slli_epi32(lower2, 16));
    __m256i upper = _mm256_mulhi_epu16(twos, _mm256_set1_epi16(6554)); /* divides by 10 */
    /* each upper byte is twos - 10 upper */
    return _mm256_add_epi16(_mm256_slli_epi16(twos, 8),
                            _mm256_mullo_epi16(upper, _mm256_set1_epi16(1 - 10 * 256)));
}

/* Writes the digits of the decimals `at` and at + 2. */
static inline void put_every_second(__m256i digits, struct gd__decimals *out, uint32_t at)
{
    __m256i text = _mm256_add_epi8(digits, _mm256_set1_epi8('0'));
    uint32_t counting =
        (uint32_t)_mm256_movemask_epi8(_mm256_cmpgt_epi8(digits, _mm256_setzero_si256()));
    _mm_storeu_si128((__m128i *)out->digits[at], _mm256_castsi256_si128(text));
    _mm_storeu_si128((__m128i *)out->digits[at + 2], _mm256_extracti128_si256(text, 1));
    out->counting[at] = (uint16_t)counting;
    out->counting[at + 2] = (uint16_t)(counting >> 16);
}

/* --- kernel ----------------------------------------------------------------------------------- */

static inline __m256i two_scales(uint64_t a, uint64_t b)
{
    const struct gd__decimal_scale *of = gd__decimal_scales.of;
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)&of[a])),
                                   _mm_loadu_si128((const __m128i *)&of[b]), 1);
}

/* Returns the decimal point of 17 digits whose last digit has the place value 10^(k - 1). 10^k is
 * the least power of ten above 2^(biased - 1075). 1262611 / 2^22 is log10(2). */
static inline lanes point_of(lanes biased)
{
    enum { UP = 400 }; /* an offset that makes all terms positive */
    return ((times(biased, all(1262611)) +
             all(UP * (UINT64_C(1) << 22) - 1075 * UINT64_C(1262611))) >>
            22) -
           all(UP - 17);
}

/* Inlined, so that the compiler clears the upper parts of the registers at the caller's return.
 * Otherwise SSE instructions stall on them. */
static inline __attribute__((always_inline)) uint32_t
find_some(lanes bits, struct gd__decimals *out, uint32_t at)
{
    enum { FIRST = GD__DECIMAL_EXPONENT, END = GD__DECIMAL_EXPONENT + GD__DECIMAL_SCALES };
    lanes biased = (bits >> FRACTION_BITS) & all(2047);
    lanes fraction = bits & all((UINT64_C(1) << FRACTION_BITS) - 1);
    lanes is_in_range = below(biased, all(END)) & ~below(biased, all(FIRST));
    lanes index = (biased - all(FIRST)) & is_in_range;
    /* loads whole entries, because a gather is slower */
    __m256i even = two_scales(index[0], index[2]), odd = two_scales(index[1], index[3]);
    lanes high = (lanes)_mm256_unpacklo_epi64(even, odd),
          low = (lanes)_mm256_unpackhi_epi64(even, odd);
    lanes x = (fraction << 9) + all((UINT64_C(1) << 61) + 256); /* the integer (2c + 1) 2^8 */
    struct found found = find_digits(scale_up(x, high, low), low >> 32);
    lanes has_16 = below(found.digits, all(UINT64_C(10000000000000000)));
    struct parts parts = part((has_16 & times_ten(found.digits)) | (~has_16 & found.digits));
    lanes place = point_of(biased) + has_16 + all(-GD__DECIMAL_LEAST);
    lanes head = parts.first + all('0') + ((bits >> 63) << 8) + (place << 16);
    _mm256_storeu_si256((__m256i *)&out->head[at], (__m256i)head);
    __m256i upper = (__m256i)parts.upper, lower = (__m256i)parts.lower;
    put_every_second(digits_of((lanes)_mm256_unpacklo_epi64(upper, lower)), out, at);
    put_every_second(digits_of((lanes)_mm256_unpackhi_epi64(upper, lower)), out, at + 1);
    return lanes_of(found.is_left_out | ~is_in_range);
}

uint32_t gd__decimals_avx2(const double *values, uint32_t count, struct gd__decimals *out)
{
    uint32_t left_out = 0;
    for (uint32_t at = 0; at < count; at += LANES) {
        /* reads zeros behind `count` */
        lanes here = below((lanes){0, 1, 2, 3}, all(count - at));
        lanes bits = (lanes)_mm256_maskload_pd(values + at, (__m256i)here);
        left_out |= find_some(bits, out, at) << at;
    }
    return left_out;
}
#endif
