/* C has no bounded, locale-free, correctly rounded conversion; C++17's <charconv> is one, and five times as fast as strtod. */
#include "gd/number.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <cstdint>
#include <limits>

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

/* The significant digits of a shortest decimal: 0.DIGITS x 10^point. */
struct digits {
    const char *text;
    size_t count;
    int point;
};

/* Takes the digits out of "d.ddde+XX", which it makes in `text`: the first one is moved over the point, to the others. */
static struct digits shortest_digits(double magnitude, char text[32])
{
    const char *end = std::to_chars(text, text + 32, magnitude, std::chars_format::scientific).ptr;
    const char *exponent = end - (end[-4] == 'e' ? 4 : 5); /* two digits, or three */
    const int point = 1 + (int)saturated_integer(exponent + 1, end);
    if (exponent - text == 1) return {text, 1, point};
    text[1] = text[0];
    return {text + 1, (size_t)(exponent - text) - 1, point};
}

static char *put(char *to, const char *text, size_t size)
{
    return (char *)std::memcpy(to, text, size) + size;
}

static char *put_zeros(char *to, size_t count)
{
    return (char *)std::memset(to, '0', count) + count;
}

static char *put_scientific(char *to, const struct digits &digits)
{
    *to++ = digits.text[0];
    if (digits.count > 1) {
        *to++ = '.';
        to = put(to, digits.text + 1, digits.count - 1);
    }
    *to++ = 'e';
    return std::to_chars(to, to + 4, digits.point - 1).ptr;
}

static char *put_plain(char *to, const struct digits &digits)
{
    if (digits.point <= 0) {
        to = put_zeros(put(to, "0.", 2), (size_t)-digits.point);
        return put(to, digits.text, digits.count);
    }
    const size_t whole = (size_t)digits.point;
    if (digits.count <= whole) return put_zeros(put(to, digits.text, digits.count), whole - digits.count);
    to = put(to, digits.text, whole);
    *to++ = '.';
    return put(to, digits.text + whole, digits.count - whole);
}

char *gd_number_format(char *at, double value)
{
    if (std::signbit(value)) *at++ = '-';
    if (value == 0) {
        *at++ = '0';
        return at;
    }
    char text[32];
    const struct digits digits = shortest_digits(std::fabs(value), text);
    return digits.point < -5 || digits.point > 17 ? put_scientific(at, digits) : put_plain(at, digits);
}
