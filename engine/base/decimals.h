/* Decimals: computes the shortest decimals of several doubles at a time, for number.h.
 *
 * The AVX2 kernel cannot convert some numbers. The caller converts them by gd__decimals_set.
 * Stateless; any thread. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    GD__DECIMALS = 24, /* largest number of values of one call; a multiple of every lane count */
    /* The decimal point of 1e-6, as in struct gd__decimals. Numbers below 1e-6 and numbers of at
     * least 1e17 are written with an exponent. The kernels do not convert them. */
    GD__DECIMAL_LEAST = -5
};

/* Each decimal is 0.DIGITS x 10^point, where DIGITS are 17 digits, padded by zeros at the end. The
 * first digit is not 0. */
struct gd__decimals {
    uint64_t head[GD__DECIMALS];     /* packed by gd__decimal_head */
    uint16_t counting[GD__DECIMALS]; /* bit i: the digit at index i of `digits` is not 0 */
    /* The digits after the first, as text. The last row is padding for reads. */
    char digits[GD__DECIMALS + 1][16];
};

/* Packs the character of the first digit, the sign, and point - GD__DECIMAL_LEAST. */
static inline uint64_t gd__decimal_head(char first, bool is_negative, int point)
{
    return (uint64_t)(unsigned char)first | (uint64_t)is_negative << 8 |
           (uint64_t)(point - GD__DECIMAL_LEAST) << 16;
}

/* Converts the first `count` values. Returns a mask in which bit i is set if value i was not
 * converted. No kernel converts zeros, infinities, NaNs and values that are written with an
 * exponent; SIMD kernels do not convert some other rare values. May overwrite rows of `out` after
 * row `count`. */
typedef uint32_t gd__decimals_kernel(const double *values, uint32_t count,
                                     struct gd__decimals *out);

extern gd__decimals_kernel gd__decimals_plain;
#if defined(__x86_64__)
extern gd__decimals_kernel gd__decimals_avx2;
#endif

/* Sets decimal i to the shortest decimal that reads back as `value`, which is finite and not 0. If
 * several decimals have this length, selects the nearest to `value`; in a tie, selects the one with
 * an even last digit. Returns the decimal's point. */
int gd__decimals_set(struct gd__decimals *decimals, uint32_t i, double value);

/* Returns the fastest kernel of this machine. */
gd__decimals_kernel *gd__decimals_kernel_here(void);

/* --- scales by binary exponent ---------------------------------------------------------------- */

/* The reals that round to a double c 2^q, 2^52 <= c < 2^53, form an interval. Its length is 2^q,
 * and its upper end is (c + 1/2) 2^q. Let 10^k be the least power of ten above 2^q. In units of
 * 10^k, the upper end is ((2c + 1) 2^8 / 2^128) times the scale, and the length is 0.1 to 1. */
struct gd__decimal_scale {
    uint64_t high; /* upper 64 bits of the scale; `low` is the 32 bits below them */
    /* `width` is the interval's length in units of 10^k, times 2^32, rounded down */
    uint32_t low, width;
};

/* Scales for 2^-19 <= value < 2^56, indexed by the value's biased exponent. */
enum { GD__DECIMAL_SCALES = 75, GD__DECIMAL_EXPONENT = 1023 - 19 };
extern const struct gd__decimal_scales {
    struct gd__decimal_scale of[GD__DECIMAL_SCALES];
} gd__decimal_scales;

#ifdef __cplusplus
}
#endif
