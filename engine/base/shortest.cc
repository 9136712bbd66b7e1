/* Computes the shortest decimal of a double. See shortest.h.
 *
 * Dragonbox: J. Jeon, "Dragonbox: a new floating-point binary-to-decimal conversion algorithm"
 * (2022), derived from R. Giulietti's Schubfach (2021). All reals in an interval around a double c
 * 2^q round to it. The interval is scaled by a power of ten to a length of 100 to 1000 units. If it
 * contains a multiple of 1000 units, that multiple is the shortest decimal. Otherwise the multiple
 * of 100 units nearest to the double is. The whole part of the interval's scaled upper end decides
 * both; it is one product with a power of 128 bits. If a remainder equals that of the lower end or
 * of the middle, the parities of the whole parts decide between the two candidates.
 *
 * The powers are computed exactly at compile time. */
#include "base/shortest.h"

#include <array>
#include <cstring>

#include "base/decimals.h"

namespace
{

using wide = unsigned __int128;

/* high 2^64 + low: a power 10^k scaled to 128 bits, rounded up */
struct power {
    std::uint64_t high, low;
};

constexpr int LEAST = -292, MOST = 326; /* range of the exponents of ten that doubles need */

/* --- powers of ten ---------------------------------------------------------------------------- */

/* 896 bits: 5^326 takes 757, and 2^895 / 5^292 has 128 significant bits */
constexpr int WORDS = 14;

/* A big integer; the least significant word comes first. */
struct big {
    std::uint64_t words[WORDS];
};

constexpr void times5(big &value)
{
    wide carry = 0;
    for (std::uint64_t &word : value.words) {
        carry += wide(word) * 5;
        word = std::uint64_t(carry);
        carry >>= 64;
    }
}

/* Divides by 5 and rounds down. After n divisions the value is the quotient by 5^n, rounded
 * down. */
constexpr void over5(big &value)
{
    wide rest = 0;
    for (int i = WORDS - 1; i >= 0; i--) {
        rest = rest << 64 | value.words[i];
        value.words[i] = std::uint64_t(rest / 5);
        rest %= 5;
    }
}

/* Returns the 64 bits from bit `low` on. Bits below the number are 0. */
constexpr std::uint64_t bits_from(const big &value, int low)
{
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; i++) {
        const int at = low + i;
        if (at >= 0 && (value.words[at / 64] >> at % 64 & 1)) bits |= std::uint64_t(1) << i;
    }
    return bits;
}

constexpr int length_of(const big &value)
{
    int word = WORDS - 1, bits = 64;
    while (!value.words[word]) word--;
    while (!(value.words[word] >> (bits - 1))) bits--;
    return 64 * word + bits;
}

/* Returns the leading 128 bits, rounded up unless they are exact. */
constexpr power leading(const big &value, bool is_exact)
{
    const int length = length_of(value);
    const wide bits = wide(bits_from(value, length - 64)) << 64 | bits_from(value, length - 128);
    const wide up = is_exact && length <= 128 ? bits : bits + 1;
    return {std::uint64_t(up >> 64), std::uint64_t(up)};
}

constexpr std::array<power, MOST - LEAST + 1> make_powers()
{
    std::array<power, MOST - LEAST + 1> powers{};
    big large{{1}}, small{};
    small.words[WORDS - 1] = std::uint64_t(1) << 63;
    for (int k = 0; k <= MOST; k++, times5(large)) powers[k - LEAST] = leading(large, true);
    for (int k = -1; k >= LEAST; k--) {
        over5(small);
        powers[k - LEAST] = leading(small, false);
    }
    return powers;
}

constexpr std::array<power, MOST - LEAST + 1> powers = make_powers();

/* --- scaling ---------------------------------------------------------------------------------- */

/* Return floor(log10(2^q)) or floor(log10(3/4 2^q)), and floor(log2(10^k)). Correct for all
 * exponents of doubles. */
constexpr int log10_of_2(int q, bool is_less)
{
    return (q * 1262611 - (is_less ? 524031 : 0)) >> 22;
}

constexpr int log2_of_10(int k)
{
    return (k * 1741647) >> 19;
}

struct product {
    std::uint64_t whole; /* the whole part of a power times x / 2^128 */
    bool is_whole;       /* the product is whole: no bits are cut off */
};

inline product multiply(const power &power, std::uint64_t x)
{
    const wide upper = wide(power.high) * x + std::uint64_t(wide(power.low) * x >> 64);
    return {std::uint64_t(upper >> 64), std::uint64_t(upper) == 0};
}

struct parity {
    bool is_odd;   /* parity of the whole part of a power times x / 2^(128 - shift) */
    bool is_whole; /* the product is whole: no bits are cut off */
};

inline parity find_parity(const power &power, std::uint64_t x, int shift)
{
    const wide lower = (wide(power.high * x) << 64) + wide(power.low) * x;
    const std::uint64_t high = std::uint64_t(lower >> 64), low = std::uint64_t(lower);
    return {bool(high >> (64 - shift) & 1), (high << shift | low >> (64 - shift)) == 0};
}

/* --- the search ------------------------------------------------------------------------------- */

constexpr std::uint64_t E15 = 1000000000000000, E16 = 10 * E15;

/* Selects one of two values. Branchless, because the branch is unpredictable. */
inline std::uint64_t select(bool condition, std::uint64_t yes, std::uint64_t no)
{
    return no ^ ((yes ^ no) & -std::uint64_t(condition));
}

/* Pads a decimal to 17 digits. */
inline gd::decimal with_zeros(std::uint64_t digits, int exponent)
{
    /* more than one step for the smallest doubles and for powers of two */
    while (digits < E15) digits *= 10, exponent--;
    const bool has_16 = digits < E16;
    return {select(has_16, 10 * digits, digits), exponent - has_16 + 17};
}

inline bool is_rare(bool condition)
{
    return __builtin_expect(condition, 0);
}

/* Finds the decimal for an interval that is symmetric about the double. Its ends belong to the
 * interval if c is even. */
inline gd::decimal search(std::uint64_t c, int q)
{
    const int k = log10_of_2(q, false) - 2, shift = q + log2_of_10(-k);
    const power &power = powers[-k - LEAST];
    const bool is_even = !(c & 1);
    const std::uint32_t length =
        /* length of the interval in units, rounded down; also half of it */
        std::uint32_t(power.high >> (63 - shift));
    const product upper = multiply(power, (2 * c + 1) << shift);
    std::uint64_t thousands = upper.whole / 1000;
    std::uint32_t rest = std::uint32_t(upper.whole - 1000 * thousands);
    bool is_thousands = rest < length;
    if (is_rare(rest == length)) {
        const parity lower = find_parity(power, 2 * c - 1, shift);
        is_thousands = lower.is_odd || (lower.is_whole && is_even);
    } else if (is_rare(rest == 0 && upper.is_whole &&
                       /* the upper end itself, which does not belong to the interval */
                       !is_even)) {
        thousands--;
        rest = 1000;
        is_thousands = false;
    }
    const std::uint32_t distance = rest - length / 2 + 50, hundreds = distance / 100;
    std::uint64_t nearest = 10 * thousands + hundreds;
    /* the middle of two candidates is just above the double, at it, or just below */
    if (is_rare(hundreds * 100 == distance && !is_thousands)) {
        const parity middle = find_parity(power, 2 * c, shift);
        const bool is_below = middle.is_odd != bool((distance ^ 50) & 1);
        nearest -= is_below || (middle.is_whole && (nearest & 1));
    }
    return with_zeros(select(is_thousands, 10 * thousands, nearest), k + 2);
}

/* Finds the decimal for 2^(q + 52), whose interval extends only half as far below it. Here the
 * interval is 1 to 10 units long. */
inline gd::decimal search_close(int q)
{
    const int k = log10_of_2(q, true), shift = q + log2_of_10(-k);
    const power &power = powers[-k - LEAST];
    const bool has_whole_end = q == 2 || q == 3, is_tie = q == -77;
    const std::uint64_t least =
        ((power.high - (power.high >> 54)) >> (11 - shift)) + !has_whole_end;
    const std::uint64_t most = (power.high + (power.high >> 53)) >> (11 - shift);
    const std::uint64_t nearest = ((power.high >> (10 - shift)) + 1) / 2, tens = most / 10 * 10;
    if (tens >= least) return with_zeros(tens, k);
    if (is_tie && (nearest & 1)) return with_zeros(nearest - 1, k);
    return with_zeros(nearest + (nearest < least), k);
}

} // namespace

gd::decimal gd::shortest(double value)
{
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    const std::uint64_t fraction = bits & ((std::uint64_t(1) << 52) - 1);
    const int biased = int(bits >> 52);
    if (is_rare(!biased)) return search(fraction, -1074);
    return is_rare(!fraction && biased > 1)
               ? search_close(biased - 1075)
               : search(fraction | std::uint64_t(1) << 52, biased - 1075);
}

/* --- scales for lanes ------------------------------------------------------------------------- */

namespace
{

/* Returns the scale for the unit 10^k, the least power of ten above 2^q. It is 2^(q + 119) / 10^k,
 * a shifted power. */
constexpr gd__decimal_scale make_scale(int q)
{
    const int k = log10_of_2(q, false) + 1;
    const power power = powers[-k - LEAST];
    const wide scale = (wide(power.high) << 64 | power.low) >> (8 - q - log2_of_10(-k));
    return {std::uint64_t(scale >> 64), std::uint32_t(scale >> 32), std::uint32_t(scale >> 87)};
}

constexpr struct gd__decimal_scales make_scales()
{
    struct gd__decimal_scales made {
    };
    for (int i = 0; i < GD__DECIMAL_SCALES; i++)
        made.of[i] = make_scale(GD__DECIMAL_EXPONENT + i - 1075);
    return made;
}

} // namespace

constexpr struct gd__decimal_scales gd__decimal_scales = make_scales();
