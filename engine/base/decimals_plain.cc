#include "base/decimals.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

int gd__decimals_set(struct gd__decimals *decimals, std::uint32_t i, double value)
{
    char text[32]; /* d.dddde+dd */
    const char *const end =
        std::to_chars(text, text + sizeof text, std::fabs(value), std::chars_format::scientific)
            .ptr;
    const char *at = text + 1;
    unsigned counting = 0;
    int exponent = 0;
    std::memset(decimals->digits[i], '0', sizeof decimals->digits[i]);
    if (*at == '.') at++;
    for (unsigned k = 0; *at != 'e'; at++, k++) {
        decimals->digits[i][k] = *at;
        counting |= unsigned(*at != '0') << k;
    }
    std::from_chars(at + (at[1] == '+' ? 2 : 1), end, exponent);
    decimals->head[i] = gd__decimal_head(text[0], std::signbit(value), exponent + 1);
    decimals->counting[i] = std::uint16_t(counting);
    return exponent + 1;
}

std::uint32_t gd__decimals_plain(const double *values, std::uint32_t count,
                                 struct gd__decimals *out)
{
    std::uint32_t left_out = 0;
    for (std::uint32_t i = 0; i < count; i++) {
        const double magnitude = std::fabs(values[i]);
        const bool is_plain = magnitude >= 1e-6 && magnitude < 1e17;
        left_out |= std::uint32_t(!is_plain) << i;
        if (is_plain) gd__decimals_set(out, i, values[i]);
    }
    return left_out;
}

/* --- scales for lanes ------------------------------------------------------------------------- */

namespace
{

/* Returns the scale for the unit 10^k, the least power of ten above 2^q: 2^(q + 119) / 10^k. */
constexpr gd__decimal_scale make_scale(int q)
{
    const int k = ((q * 1262611) >> 22) + 1; /* the first term is floor(log10(2^q)) */
    unsigned __int128 scale = 1;
    for (int i = 0; i < -k; i++) scale *= 5;
    scale = k > 0 ? (scale << (q + 118)) / 5 : scale << (q + 119 - k);
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
