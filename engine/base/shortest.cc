/* See shortest.h.
 *
 * Schubfach: R. Giulietti, "The Schubfach way to render doubles" (2021). A double c 2^q is what all reals of an interval about it are
 * rounded to. With the greatest power of ten that is not longer than the interval as unit, the interval holds one or two multiples of
 * the unit, and perhaps one of ten units. Which of them it holds is decided by scaling value and interval's ends to the unit in 64
 * bits: a product with a power of ten of 126 bits or more is right whenever the comparison is not with an integer, and a bit that
 * says that something was cut off (rounding to odd) keeps it right there too (section 9.9).
 *
 * The powers are computed exactly when this is compiled. */
#include "base/shortest.h"

#include <array>
#include <cstring>

namespace
{

using wide = unsigned __int128;

struct power { /* high 2^64 + low: 10^k scaled to 128 bits, rounded up */
    std::uint64_t high, low;
};

constexpr int LEAST = -292, MOST = 324; /* exponents of ten that doubles need */

/* --- powers of ten ------------------------------------------------------------------------------------------------ */

constexpr int WORDS = 14; /* 896 bits: 5^324 takes 753, and 128 are left of 2^895 / 5^292 */

/* A big integer, from its least significant word on. */
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

/* Rounds down: after n times it is the quotient by 5^n, rounded down. */
constexpr void over5(big &value)
{
    wide rest = 0;
    for (int i = WORDS - 1; i >= 0; i--) {
        rest = rest << 64 | value.words[i];
        value.words[i] = std::uint64_t(rest / 5);
        rest %= 5;
    }
}

/* The 64 bits from the bit `low` on; what lies below the number is 0. */
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

/* The leading 128 bits; one more in the last place unless they are all there is. */
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

/* --- scaling ------------------------------------------------------------------------------------------------------ */

/* floor(log10(2^q)), or of 3/4 2^q; floor(log2(10^k)). Right for all exponents of doubles (sections 9.7 and 9.8). */
inline int log10_of_2(int q, bool is_less)
{
    return (q * 1262611 - (is_less ? 524031 : 0)) >> 22;
}

inline int log2_of_10(int k)
{
    return (k * 1741647) >> 19;
}

/* floor(power x / 2^128), with the last bit set if something was cut off. */
inline std::uint64_t scale(const power &power, std::uint64_t x)
{
    const wide low = wide(power.low) * x, high = wide(power.high) * x + std::uint64_t(low >> 64);
    return std::uint64_t(high >> 64) | (std::uint64_t(high) > 1);
}

/* --- the search --------------------------------------------------------------------------------------------------- */

/* Value and interval's ends in quarters of the unit. */
struct scaled {
    std::uint64_t low, value, high;
};

/* The multiple of the unit that is the answer. */
inline std::uint64_t choose(const scaled &scaled)
{
    const std::uint64_t below = scaled.value / 4, middle = 4 * below + 2;
    const bool has_below = scaled.low <= 4 * below, has_above = 4 * below + 4 <= scaled.high;
    if (has_below != has_above) return below + has_above;
    return below + (scaled.value > middle || (scaled.value == middle && (below & 1)));
}

/* The multiple of ten units, in tens, that the interval holds; 0: none, or two. */
inline std::uint64_t choose_ten(const scaled &scaled)
{
    const std::uint64_t below = scaled.value / 40;
    const bool has_below = scaled.low <= 40 * below, has_above = 40 * below + 40 <= scaled.high;
    return has_below != has_above ? below + has_above : 0;
}

inline gd::decimal without_zeros(gd::decimal decimal)
{
    while (decimal.digits % 100000000 == 0) decimal = {decimal.digits / 100000000, decimal.exponent + 8};
    while (decimal.digits % 10 == 0) decimal = {decimal.digits / 10, decimal.exponent + 1};
    return decimal;
}

} // namespace

gd::decimal gd::shortest(double value)
{
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    const std::uint64_t fraction = bits & ((std::uint64_t(1) << 52) - 1);
    const int biased = int(bits >> 52);
    const std::uint64_t c = biased ? fraction | std::uint64_t(1) << 52 : fraction;
    const int q = (biased ? biased : 1) - 1075;
    const bool is_odd = c & 1, is_close = fraction == 0 && biased > 1; /* to the double below, whose binade is finer */
    const int k = log10_of_2(q, is_close), shift = q + log2_of_10(-k) + 1;
    const power &power = powers[-k - LEAST];
    const scaled scaled = {scale(power, (4 * c - 2 + is_close) << shift) + is_odd, scale(power, 4 * c << shift),
                           scale(power, (4 * c + 2) << shift) - is_odd};
    if (const std::uint64_t tens = choose_ten(scaled)) return without_zeros({tens, k + 1});
    return without_zeros({choose(scaled), k});
}
