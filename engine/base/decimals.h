/* Decimals: the shortest decimals of many doubles at a time, as what number.h writes is put
 * together from.
 *
 * One algorithm (decimals_lanes.h) is compiled for each set of lanes; what it leaves out, and what
 * it finds, is shortest.h's. Stateless; any thread. */
#ifndef GD_BASE_DECIMALS_H
#define GD_BASE_DECIMALS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    GD__DECIMALS = 24, /* that are found at a time, at most; a multiple of all lanes */
    /* the point of 1e-6: decimals with an exponent, below it and from 1e17 on, are not found
       here */
    GD__DECIMAL_LEAST = -5
};

/* 0.DIGITS x 10^point: of 17 digits, the first of them not 0, with zeros behind the last one that
 * counts. */
struct gd__decimals {
    uint64_t head[GD__DECIMALS];     /* see gd__decimal_head */
    uint16_t counting[GD__DECIMALS]; /* bit i: digit i of those behind the first is not 0 */
    /* those behind the first, as text; the last row may be read, but says nothing */
    char digits[GD__DECIMALS + 1][16];
};

/* First digit (text), sign, and point, counted from the least. */
static inline uint64_t gd__decimal_head(char first, bool is_negative, int point)
{
    return (uint64_t)(unsigned char)first | (uint64_t)is_negative << 8 |
           (uint64_t)(point - GD__DECIMAL_LEAST) << 16;
}

/* Finds the decimals of the first `count` values. Returns which it has left out, bit i for value i:
 * zero, what is not finite, what is written with an exponent, and, in lanes, what is not often met.
 * Of the rows behind `count` it may write some. */
typedef uint32_t gd__decimals_kernel(const double *values, uint32_t count,
                                     struct gd__decimals *out);

extern gd__decimals_kernel gd__decimals_plain;
#if defined(__x86_64__)
extern gd__decimals_kernel gd__decimals_avx2, gd__decimals_avx512;
#endif

/* Decimal i of given digits, and a point from the least to 17. */
void gd__decimals_set(struct gd__decimals *decimals, uint32_t i, uint64_t digits, int point,
                      bool is_negative);

/* The fastest that this machine has. */
gd__decimals_kernel *gd__decimals_kernel_here(void);

/* --- of one binary exponent ------------------------------------------------------------------- */

/* A double c 2^q, 2^52 <= c < 2^53, is what reals up to (c + 1/2) 2^q are rounded to, an interval
 * 2^q long. Where 10^k is the least power of ten above 2^q, that upper end is (2c + 1) 2^8 / 2^128
 * times the scale, and the length 0.1 to 1 units of 10^k. */
struct gd__decimal_scale {
    uint64_t high;       /* of the scale, and the 32 bits below them */
    uint32_t low, width; /* the length x 2^32, rounded down */
};

/* For 2^-19 <= value < 2^56, by the value's biased exponent. */
enum { GD__DECIMAL_SCALES = 75, GD__DECIMAL_EXPONENT = 1023 - 19 };
extern const struct gd__decimal_scales {
    struct gd__decimal_scale of[GD__DECIMAL_SCALES];
} gd__decimal_scales;

#ifdef __cplusplus
}
#endif

#endif
