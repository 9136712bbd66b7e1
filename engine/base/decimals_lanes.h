/* Decimals in SIMD lanes. decimals_avx2.c and decimals_avx512.c define the lanes, which are 64-bit
 * integers, and then include this file.
 *
 * The algorithm is Dragonbox as in shortest.cc, with fractions instead of remainders. In units of
 * 10^k (decimals.h) an interval is 0.1 to 1 long. If the fraction of its upper end is less than its
 * length, the whole part of the upper end is the shortest decimal. Otherwise the shortest decimal
 * is the multiple of 1/10 nearest to the interval's middle. Fractions have 32 bits and are at most
 * 5 units too small. If that precision does not decide, the number is left out: one in thirty
 * million, and all ties. The interval of a power of two extends only half as far below it. That
 * changes no result for the 75 exponents of the scales (test_decimals.c tests all).
 *
 * `times` multiplies the lower halves of lanes. `below` compares numbers below 2^63. `pick` selects
 * by lane; `chosen` selects or returns zero. `load_first` pads with zeros behind `count`. `evens`
 * and `odds` interleave every second lane of a and b. Functions with 16 or 32 in their names work
 * on parts of that many bits. */
#include "base/decimals.h"

#define FRACTION_BITS 52
#define HALF          INT64_C(0xffffffff) /* the lower half of a lane */
#define MARGIN        8                   /* margin of comparisons of fractions, up and down */
#define TENTHS_MARGIN 64                  /* margin of tenths, whose error is ten times as large */

/* Returns true if the lower half, as a number modulo 2^32, is within a margin of 0. */
static inline choice is_near_0(lanes a, int64_t margin)
{
    return below(both(add(a, all(margin)), all(HALF)), all(2 * margin + 1));
}

static inline lanes times_ten(lanes a)
{
    return add(left(a, 3), left(a, 1));
}

/* --- the decimal ------------------------------------------------------------------------------ */

/* The upper end of an interval, in units of 10^k. */
struct upper {
    lanes whole, fraction; /* `whole` has 54 bits, `fraction` 32 */
};

/* Multiplies x < 2^62 by a scale. The lowest bits below the fraction are incomplete. */
static inline struct upper scale_up(lanes x, lanes high, lanes low)
{
    lanes x1 = right(x, 32), high1 = right(high, 32);
    lanes middle = add(times(x, high1), add(right(times(x, high), 32), right(times(x1, low), 32)));
    middle = add(middle, times(x1, high)); /* the sum is below 2^63 */
    return (struct upper){add(times(x1, high1), right(middle, 32)), both(middle, all(HALF))};
}

/* The digits, 16 or 17, and the lanes that are left out. */
struct found {
    lanes digits;
    choice is_left_out;
};

static inline struct found find_digits(struct upper upper, lanes width)
{
    lanes from_middle = subtract(upper.fraction, right(width, 1));
    lanes tenths = add(times(from_middle, all(10)), all(INT64_C(1) << 31));
    choice is_whole = below(upper.fraction, width);
    choice is_unclear = either(is_near_0(upper.fraction, MARGIN),
                               is_near_0(subtract(upper.fraction, width), MARGIN));
    return (struct found){add(times_ten(upper.whole), unchosen(right(tenths, 32), is_whole)),
                          either(is_unclear, unless(is_near_0(tenths, TENTHS_MARGIN), is_whole))};
}

/* --- text ------------------------------------------------------------------------------------- */

/* A number below 10^17, split into its first digit and two groups of eight. */
struct parts {
    lanes first, upper, lower;
};

static inline struct parts part(lanes digits)
{
    lanes e8 = all(100000000);
    /* the quotient by 10^8, or one less */
    lanes quotient = right(times(right(digits, 25), all(2882303761)), 33);
    lanes rest = subtract(digits, times(quotient, e8));
    choice is_less = below(all(99999999), rest);
    quotient = add(quotient, chosen(all(1), is_less));
    lanes first = right(times(quotient, all(1441151881)), 57); /* divides by 10^8 */
    return (struct parts){first, subtract(quotient, times(first, e8)),
                          subtract(rest, chosen(e8, is_less))};
}

/* Returns the digits, one byte each, of two eight-digit numbers side by side. Splits them into
 * halves, quarters and bytes. */
static inline lanes digits_of(lanes eights)
{
    lanes upper4 = right(times(eights, all(3518437209)), 45); /* divides by 10000 */
    lanes lower4 = subtract(eights, times(upper4, all(10000)));
    lanes fours = add(upper4, left(lower4, 32));
    lanes upper2 = right16(times16_high(fours, all32(5243)), 3); /* divides by 100 */
    lanes lower2 = subtract16(fours, times16(upper2, all32(100)));
    lanes twos = add(upper2, left32(lower2, 16));
    lanes upper = times16_high(twos, all16(6554)); /* divides by 10 */
    /* each upper byte is twos - 10 upper */
    return add16(left16(twos, 8), times16(upper, all16(1 - 10 * 256)));
}

/* --- kernel ----------------------------------------------------------------------------------- */

/* Returns the decimal point of 17 digits whose last digit counts 10^(k - 1), where 10^k is the
 * least power of ten above 2^(biased - 1075). 1262611 / 2^22 is log10(2). */
static inline lanes point_of(lanes biased)
{
    enum { UP = 400 }; /* makes all terms positive */
    lanes log = right(
        add(times(biased, all(1262611)), all(UP * (INT64_C(1) << 22) - 1075 * INT64_C(1262611))),
        22);
    return add(log, all(17 - UP));
}

/* Inlined, so that the compiler clears the upper parts of the registers at the caller's return.
 * Otherwise SSE instructions stall on them. */
static inline __attribute__((always_inline)) uint32_t
find_some(lanes bits, struct gd__decimals *out, uint32_t at)
{
    enum { FIRST = GD__DECIMAL_EXPONENT, END = GD__DECIMAL_EXPONENT + GD__DECIMAL_SCALES };
    lanes biased = both(right(bits, FRACTION_BITS), all(2047)), high, low;
    lanes fraction = both(bits, all((INT64_C(1) << FRACTION_BITS) - 1));
    choice is_in_range = unless(below(biased, all(END)), below(biased, all(FIRST)));
    load_scales(chosen(subtract(biased, all(FIRST)), is_in_range), &high, &low);
    lanes x = add(left(fraction, 9), all((INT64_C(1) << 61) + 256)); /* the integer (2c + 1) 2^8 */
    struct found found = find_digits(scale_up(x, high, low), right(low, 32));
    choice has_16 = below(found.digits, all(INT64_C(10000000000000000)));
    struct parts parts = part(pick(has_16, times_ten(found.digits), found.digits));
    lanes place = subtract(point_of(biased), add(chosen(all(1), has_16), all(GD__DECIMAL_LEAST)));
    store(&out->head[at],
          add(add(parts.first, all('0')), add(left(right(bits, 63), 8), left(place, 16))));
    put_rows(digits_of(evens(parts.upper, parts.lower)), digits_of(odds(parts.upper, parts.lower)),
             out, at);
    return lanes_of(found.is_left_out) | (lanes_of(is_in_range) ^ ALL_LANES);
}

uint32_t KERNEL(decimals)(const double *values, uint32_t count, struct gd__decimals *out)
{
    uint32_t left_out = 0;
    for (uint32_t at = 0; at < count; at += LANES)
        left_out |= find_some(load_first(values + at, count - at), out, at) << at;
    return left_out;
}
