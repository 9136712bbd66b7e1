/* C has no bounded, locale-free, correctly rounded conversion. C++17's <charconv> reads, five times as fast as strtod; what it writes
 * takes three times as long as shortest.h. */
#include "gd/number.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <cstdint>
#include <limits>

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

const char *gd_number_parse(const char *at, const char *end, double *out)
{
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

static const uint64_t tens[DIGITS + 1] = {1,
                                          10,
                                          100,
                                          1000,
                                          10000,
                                          100000,
                                          1000000,
                                          10000000,
                                          100000000,
                                          1000000000,
                                          10000000000,
                                          100000000000,
                                          1000000000000,
                                          10000000000000,
                                          100000000000000,
                                          1000000000000000,
                                          10000000000000000,
                                          100000000000000000};

static int count_digits(uint64_t value)
{
    const int guess = (64 - __builtin_clzll(value)) * 1233 >> 12; /* 1233/4096 is log10(2) */
    return guess + (value >= tens[guess]);
}

/* Writes eight digits, leading zeros included: halves, quarters, eighths, each beside the others in one word. */
static void put8(char *to, uint32_t value)
{
    static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the first digit is the lowest byte");
    uint64_t parts = value / 10000 | (uint64_t)(value % 10000) << 32;
    uint64_t upper = (parts * 10486 >> 20) & 0x0000007f0000007f; /* each part / 100 */
    parts = upper | (parts - 100 * upper) << 16;
    upper = (parts * 103 >> 10) & 0x000f000f000f000f; /* each part / 10 */
    parts = (upper | (parts - 10 * upper) << 8) + 0x3030303030303030;
    std::memcpy(to, &parts, sizeof parts);
}

/* The significant digits of a number 0.DIGITS x 10^point. */
struct significant {
    uint64_t digits; /* DIGITS of them, zeros behind the last one that counts */
    int count, point;
};

static significant significant_of(double magnitude)
{
    const gd::decimal decimal = gd::shortest(magnitude);
    const int count = count_digits(decimal.digits);
    return {decimal.digits * tens[DIGITS - count], count, count + decimal.exponent};
}

/* Writes all DIGITS. */
static void put_digits(char *to, uint64_t digits)
{
    *to = (char)('0' + digits / tens[16]);
    digits %= tens[16];
    put8(to + 1, (uint32_t)(digits / tens[8]));
    put8(to + 9, (uint32_t)(digits % tens[8]));
}

/* Writes the digits with a point behind the first `whole` ones, if any are left behind it. */
static char *put_pointed(char *to, const significant &number, int whole)
{
    put_digits(to + 1, number.digits);
    std::memmove(to, to + 1, (size_t)whole);
    to[whole] = '.';
    return to + (number.count > whole ? number.count + 1 : whole);
}

static char *put_scientific(char *to, const significant &number)
{
    to = put_pointed(to, number, 1);
    *to++ = 'e';
    return std::to_chars(to, to + 4, number.point - 1).ptr;
}

static char *put_plain(char *to, const significant &number)
{
    if (number.point > 0) return put_pointed(to, number, number.point);
    std::memcpy(to, "0.00000", 7);
    put_digits(to + 2 - number.point, number.digits);
    return to + 2 - number.point + number.count;
}

char *gd_number_format(char *at, double value)
{
    if (std::signbit(value)) *at++ = '-';
    if (value == 0) {
        *at++ = '0';
        return at;
    }
    const significant number = significant_of(std::fabs(value));
    return number.point < -5 || number.point > DIGITS ? put_scientific(at, number) : put_plain(at, number);
}
