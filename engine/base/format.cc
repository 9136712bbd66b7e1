#include "gd/number.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/decimals.h"

gd__decimals_kernel *gd__decimals_kernel_here(void)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return gd__decimals_avx2;
#endif
    return gd__decimals_plain;
}

namespace
{

/* Number of positions of the decimal point, from -5 (five zeros before the digits) to 17 (behind
 * the last digit). */
constexpr int POINTS = 23;

/* The layout of a number's text. First, all digits are written to the text from index `digits` on.
 * Then the point is written at index `point`, and the digits after the point are written behind it:
 * those from index `tail` of gd__decimals.digits on. */
struct layout {
    unsigned char digits, point, tail;
    /* False if the number has no point between its digits. The point is then written outside the
     * number's text. */
    bool is_pointed_within;
};

constexpr std::array<layout, POINTS> make_layouts()
{
    std::array<layout, POINTS> made{};
    for (int i = 0; i < POINTS; i++) {
        const int point = i + GD__DECIMAL_LEAST;
        made[i] = point > 0 ? layout{0, (unsigned char)point, (unsigned char)(point - 1), true}
                            : layout{(unsigned char)(2 - point), GD_NUMBER_SIZE, 0, false};
    }
    return made;
}

constexpr std::array<layout, POINTS> layouts = make_layouts();

/* Writes a converted number and returns the end of its text. May write up to SLACK bytes past this
 * end. Branchless, because the branches would be unpredictable. */
inline char *put(char *at, const gd__decimals &decimals, std::size_t i)
{
    const std::uint64_t head = decimals.head[i];
    const layout &layout = layouts[head >> 16];
    const char *const digits = decimals.digits[i];
    /* number of significant digits */
    const unsigned count = 32 - unsigned(__builtin_clz(2u * decimals.counting[i] + 1));
    char tail[16];
    *at = '-';
    at += head >> 8 & 1;
    std::memcpy(at, "0.00000", 8);
    at[layout.digits] = (char)head;
    std::memcpy(at + layout.digits + 1, digits, 16);
    std::memcpy(tail, digits + layout.tail, 16);
    at[layout.point] = '.';
    std::memcpy(at + layout.point + 1, tail, 16);
    const unsigned size = layout.digits + count + layout.is_pointed_within;
    const bool is_integer = layout.is_pointed_within && count <= layout.point;
    return at + (is_integer ? layout.point : size);
}

char *put_zero(char *at, double value)
{
    *at = '-';
    at += std::signbit(value);
    *at++ = '0';
    return at;
}

/* Writes a number with an exponent. `point` is its decimal point. */
char *put_scientific(char *at, gd__decimals &decimal, int point)
{
    decimal.head[0] += std::uint64_t(1 - point) << 16; /* the point is behind the first digit */
    at = put(at, decimal, 0);
    *at++ = 'e';
    return std::to_chars(at, at + 4, point - 1).ptr;
}

/* Writes a number that the kernel did not convert. */
char *put_left_out(char *at, double value)
{
    if (std::isfinite(value)) return gd_number_format(at, value);
    std::memcpy(at, "null", 4);
    return at + 4;
}

/* The converted numbers of a run of values. */
struct run {
    gd__decimals decimals;
    std::uint32_t left_out;
};

/* Writes number i of the run and a comma. */
inline char *put_item(char *at, const run &run, const double *values, std::size_t i)
{
    at = __builtin_expect(run.left_out >> i & 1, 0) ? put_left_out(at, values[i])
                                                    : put(at, run.decimals, i);
    *at++ = ',';
    return at;
}

/* Writes a comma after each number. If IN_TRIPLES, writes arrays of three numbers, with a comma
 * after each array. */
template <bool IN_TRIPLES> char *put_all(char *at, const double *values, std::size_t count)
{
    static_assert(GD__DECIMALS % 3 == 0, "a triple is in one run");
    gd__decimals_kernel *const kernel = gd__decimals_kernel_here();
    run run;
    for (std::size_t begin = 0; begin < count; begin += GD__DECIMALS) {
        const std::size_t part = std::min(count - begin, std::size_t(GD__DECIMALS));
        run.left_out = kernel(values + begin, std::uint32_t(part), &run.decimals);
        for (std::size_t i = 0; i < part; i++) {
            if (IN_TRIPLES && i % 3 == 0) *at++ = '[';
            at = put_item(at, run, values + begin, i);
            if (!IN_TRIPLES || i % 3 != 2) continue;
            at[-1] = ']';
            *at++ = ',';
        }
    }
    return at;
}

} // namespace

char *gd_number_format(char *at, double value)
{
    char text[GD_NUMBERS_SIZE(1)];
    gd__decimals decimal;
    if (value == 0) return put_zero(at, value);
    const int point = gd__decimals_set(&decimal, 0, value);
    const bool is_plain = point >= GD__DECIMAL_LEAST && point <= 17;
    const char *const end = is_plain ? put(text, decimal, 0) : put_scientific(text, decimal, point);
    std::memcpy(at, text, GD_NUMBER_SIZE);
    return at + (end - text);
}

char *gd_numbers_format(char *at, const double *values, std::size_t count)
{
    return put_all<false>(at, values, count);
}

char *gd_triples_format(char *at, const double (*values)[3], std::size_t count)
{
    return put_all<true>(at, *values, 3 * count);
}
