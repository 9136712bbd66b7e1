/* Decimals by lanes; included by decimals_avx2.c and decimals_avx512.c behind their lanes, which
 * are whole numbers of 64 bits.
 *
 * Dragonbox as in shortest.cc, but with fractions instead of remainders: in units of a thousand of
 * its own ones an interval is at most one long, so that its upper end's whole part is the shortest
 * decimal if the fraction behind it is less than the length, and else the tenth nearest to the
 * middle is. Fractions have 32 bits and are at most 5 units too small: where more would be needed
 * to decide, the number is left out. That is so of one in thirty million, and of all ties. The
 * interval of a power of two reaches only half as far down, but none of the 75 that the scales are
 * for is found to be another for that (test_decimals.c looks at all).
 *
 * `times` multiplies lower halves; `below` is asked about numbers below 2^63 only; `pick` chooses
 * lane by lane, `chosen` has zeros elsewhere; `load_first` has zeros behind `count`; `evens` and
 * `odds` take every second lane of a and b in turn. Names with 16 or 32 take parts of so many
 * bits. */
#include "base/decimals.h"

#define FRACTION_BITS 52
#define HALF          INT64_C(0xffffffff) /* the lower one */
#define MARGIN        8                   /* of comparisons of fractions, to both sides */
#define TENTHS_MARGIN 64                  /* of tenths, which have ten times the error */

/* Is the lower half, taken round, within a margin of 0? */
static inline choice is_near_0(lanes a, int64_t margin)
{
    return below(both(add(a, all(margin)), all(HALF)), all(2 * margin + 1));
}

static inline lanes times_ten(lanes a)
{
    return add(left(a, 3), left(a, 1));
}

/* --- the decimal ------------------------------------------------------------------------------ */

/* The interval's upper end. */
struct upper {
    lanes whole, fraction; /* 54 bits; 32 bits */
};

/* A scale times x < 2^62, but for some of what is below the fraction. */
static inline struct upper scale_up(lanes x, lanes high, lanes low)
{
    lanes x1 = right(x, 32), high1 = right(high, 32);
    lanes middle = add(times(x, high1), add(right(times(x, high), 32), right(times(x1, low), 32)));
    middle = add(middle, times(x1, high)); /* below 2^63 */
    return (struct upper){add(times(x1, high1), right(middle, 32)), both(middle, all(HALF))};
}

/* Sixteen or seventeen digits, and which are to be found otherwise. */
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

/* --- as text ---------------------------------------------------------------------------------- */

/* A number below 10^17: its first digit, and two times eight more. */
struct parts {
    lanes first, upper, lower;
};

static inline struct parts part(lanes digits)
{
    lanes e8 = all(100000000);
    /* by 10^8, or one less */
    lanes quotient = right(times(right(digits, 25), all(2882303761)), 33);
    lanes rest = subtract(digits, times(quotient, e8));
    choice is_less = below(all(99999999), rest);
    quotient = add(quotient, chosen(all(1), is_less));
    lanes first = right(times(quotient, all(1441151881)), 57); /* by 10^8 */
    return (struct parts){first, subtract(quotient, times(first, e8)),
                          subtract(rest, chosen(e8, is_less))};
}

/* The digits, a byte each, of two numbers of eight digits that stand beside each other: halves,
 * quarters and so on do, too. */
static inline lanes digits_of(lanes eights)
{
    lanes upper4 = right(times(eights, all(3518437209)), 45); /* / 10000 */
    lanes lower4 = subtract(eights, times(upper4, all(10000)));
    lanes fours = add(upper4, left(lower4, 32));
    lanes upper2 = right16(times16_high(fours, all32(5243)), 3); /* / 100 */
    lanes lower2 = subtract16(fours, times16(upper2, all32(100)));
    lanes twos = add(upper2, left32(lower2, 16));
    lanes upper = times16_high(twos, all16(6554)); /* / 10 */
    /* upper, and above it twos - 10 upper */
    return add16(left16(twos, 8), times16(upper, all16(1 - 10 * 256)));
}

/* --- all of it -------------------------------------------------------------------------------- */

/* The point of 17 digits whose unit is a hundredth of the power of ten above 2^(biased - 1075):
 * 1262611 / 2^22 is log10(2). */
static inline lanes point_of(lanes biased)
{
    enum { UP = 400 }; /* so that nothing is negative */
    lanes log = right(
        add(times(biased, all(1262611)), all(UP * (INT64_C(1) << 22) - 1075 * INT64_C(1262611))),
        22);
    return add(log, all(17 - UP));
}

/* Inlined, so that the compiler sees what the caller returns with: a call leaves the upper parts of
 * registers in use, and SSE instructions wait for them. */
static inline __attribute__((always_inline)) uint32_t
find_some(lanes bits, struct gd__decimals *out, uint32_t at)
{
    enum { FIRST = GD__DECIMAL_EXPONENT, END = GD__DECIMAL_EXPONENT + GD__DECIMAL_SCALES };
    lanes biased = both(right(bits, FRACTION_BITS), all(2047)), high, low;
    lanes fraction = both(bits, all((INT64_C(1) << FRACTION_BITS) - 1));
    choice is_in_range = unless(below(biased, all(END)), below(biased, all(FIRST)));
    load_scales(chosen(subtract(biased, all(FIRST)), is_in_range), &high, &low);
    lanes x = add(left(fraction, 9), all((INT64_C(1) << 61) + 256)); /* (2c + 1) 2^8 */
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
