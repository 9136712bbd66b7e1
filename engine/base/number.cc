/* C has no bounded, locale-free, correctly rounded conversion. C++17's <charconv> reads, five times as fast as strtod; what it writes
 * takes three times as long as shortest.h. */
#include "gd/number.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/shortest.h"

/* --- from text ---------------------------------------------------------------------------------------------------- */

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static int64_t saturated_integer(const char *at, const char *end)
{
    const int64_t limit = std::numeric_limits<int64_t>::max() / 16;
    const bool negative = at < end && *at == '-';
    int64_t value = 0;
    if (at < end && (*at == '-' || *at == '+')) at++;
    for (; at < end && value < limit; at++) value = 10 * value + (*at - '0');
    return negative ? -value : value;
}

/* Whether the well-formed number in [at, end), known to be nearer to zero than any double or larger than all, is the former: its leading
 * digit's decimal exponent tells. */
static bool is_tiny(const char *at, const char *end)
{
    int64_t exponent = 0;
    bool fraction = false, leading = true;
    for (; at < end && (is_digit(*at) || *at == '.' || *at == '-'); at++) {
        if (*at == '.') fraction = true;
        if (!is_digit(*at)) continue;
        if (leading && *at == '0') {
            exponent -= fraction;
        } else {
            leading = false;
            exponent += !fraction;
        }
    }
    if (at < end) exponent += saturated_integer(at + 1, end);
    return exponent < 0;
}

#define EXACT_DIGITS                                                                                                   \
    15 /* whole numbers and powers of ten of so many are doubles, and one division of the two rounds correctly */

/* Reads "-0.25" and the like: digits, a point, digits, not many of them, and nothing behind them that might belong to the number. NULL: it is
 * something else. */
static const char *parse_short(const char *at, const char *end, double *out)
{
    static const double tens[EXACT_DIGITS + 1] = {1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    const bool is_negative = at < end && *at == '-';
    const char *const first = at + is_negative;
    int64_t digits = 0;
    for (at = first; at < end && is_digit(*at) && at - first < EXACT_DIGITS; at++) digits = 10 * digits + (*at - '0');
    if (at == first || end - at < 2 || *at != '.') return nullptr;
    const char *const point = at++;
    for (; at < end && is_digit(*at) && at - first <= EXACT_DIGITS; at++) digits = 10 * digits + (*at - '0');
    if (at == point + 1 || (at < end && (is_digit(*at) || (*at | 0x20) == 'e'))) return nullptr;
    *out = (double)(is_negative ? -digits : digits) / tens[at - point - 1];
    if (is_negative && !digits) *out = -0.0;
    return at;
}

const char *gd_number_parse(const char *at, const char *end, double *out)
{
    if (const char *behind = parse_short(at, end, out)) return behind;
    if (end - at > 1 && *at == '+' && (is_digit(at[1]) || at[1] == '.')) at++;
    const std::from_chars_result result = std::from_chars(at, end, *out);
    if (result.ec == std::errc::invalid_argument) return nullptr;
    if (result.ec == std::errc::result_out_of_range) {
        const double magnitude = is_tiny(at, result.ptr) ? 0 : std::numeric_limits<double>::infinity();
        *out = *at == '-' ? -magnitude : magnitude;
    }
    return result.ptr;
}

/* --- to text ------------------------------------------------------------------------------------------------------ */

#define DIGITS 17 /* of any shortest decimal, at most */

#ifdef __SSE2__

/* Writes the digits of a number below 10^16, leading zeros included; returns how many there are without zeros behind the last one that counts.
 * Halves, quarters and so on stand beside each other in one register. */
static int put16(char *to, uint64_t value)
{
    const __m128i halves = _mm_set_epi64x((int64_t)(value % 100000000), (int64_t)(value / 100000000));
    const __m128i upper4 = _mm_srli_epi64(_mm_mul_epu32(halves, _mm_set1_epi64x(3518437209)), 45); /* / 10000 */
    const __m128i lower4 = _mm_sub_epi32(halves, _mm_mul_epu32(upper4, _mm_set1_epi64x(10000)));
    const __m128i fours = _mm_or_si128(upper4, _mm_slli_epi64(lower4, 32));
    const __m128i upper2 = _mm_srli_epi16(_mm_mulhi_epu16(fours, _mm_set1_epi32(5243)), 3); /* / 100 */
    const __m128i lower2 = _mm_sub_epi16(fours, _mm_mullo_epi16(upper2, _mm_set1_epi32(100)));
    const __m128i twos = _mm_or_si128(upper2, _mm_slli_epi32(lower2, 16));
    const __m128i upper = _mm_mulhi_epu16(twos, _mm_set1_epi16(6554)); /* / 10 */
    const __m128i lower = _mm_sub_epi16(twos, _mm_mullo_epi16(upper, _mm_set1_epi16(10)));
    const __m128i digits = _mm_or_si128(upper, _mm_slli_epi16(lower, 8));
    const unsigned counting = (unsigned)_mm_movemask_epi8(_mm_cmpgt_epi8(digits, _mm_setzero_si128()));
    _mm_storeu_si128((__m128i *)to, _mm_add_epi8(digits, _mm_set1_epi8('0')));
    return counting ? 32 - __builtin_clz(counting) : 0;
}

#else

static int put16(char *to, uint64_t value)
{
    int count = 0;
    for (int i = 15; i >= 0; i--, value /= 10) {
        to[i] = (char)('0' + value % 10);
        if (!count && to[i] != '0') count = i + 1;
    }
    return count;
}

#endif

/* Writes all DIGITS; returns how many of them count. */
static int put_digits(char *to, uint64_t digits)
{
    const uint64_t first = digits / 10000000000000000;
    *to = (char)('0' + first);
    return 1 + put16(to + 1, digits - first * 10000000000000000);
}

/* Writes the digits with a point behind the first `whole` ones, if any are left behind it. */
static char *put_pointed(char *to, uint64_t digits, int whole)
{
    const int count = put_digits(to + 1, digits);
    std::memmove(to, to + 1, (size_t)whole);
    to[whole] = '.';
    return to + (count > whole ? count + 1 : whole);
}

static char *put_scientific(char *to, const struct gd_decimal *number)
{
    to = put_pointed(to, number->digits, 1);
    *to++ = 'e';
    return std::to_chars(to, to + 4, number->point - 1).ptr;
}

static char *put_plain(char *to, const struct gd_decimal *number)
{
    if (number->point > 0) return put_pointed(to, number->digits, number->point);
    std::memcpy(to, "0.00000", 8);
    to += 2 - number->point;
    return to + put_digits(to, number->digits);
}

void gd_decimals(const double *values, size_t count, struct gd_decimal *out)
{
    for (size_t i = 0; i < count; i++) {
        const double magnitude = std::fabs(values[i]);
        const gd::decimal found = magnitude ? gd::shortest(magnitude) : gd::decimal{0, 0};
        out[i] = {found.digits, found.point, std::signbit(values[i])};
    }
}

char *gd_decimal_format(char *at, const struct gd_decimal *number)
{
    *at = '-';
    at += number->is_negative;
    if (!number->digits) {
        *at++ = '0';
        return at;
    }
    return number->point < -5 || number->point > DIGITS ? put_scientific(at, number) : put_plain(at, number);
}

char *gd_number_format(char *at, double value)
{
    struct gd_decimal number;
    gd_decimals(&value, 1, &number);
    return gd_decimal_format(at, &number);
}
