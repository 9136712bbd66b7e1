/* Number: double <-> decimal text, correctly rounded both ways, bounded, whatever the process' locale. Thread-safe. */
#ifndef GD_NUMBER_H
#define GD_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the longest decimal number at `at`, an optional sign first. Returns its end, NULL if there is none. Too large gives +-INFINITY, too
 * small +-0; "inf" and "nan" are read as such, for the caller to refuse. Some 20 ns. */
const char *gd_number_parse(const char *at, const char *end, double *out);

/* Longest text of a double: "-0.0000012345678901234567" or "-2.2250738585072014e-308". */
#define GD_NUMBER_SIZE 26

/* Writes the shortest decimal that reads back as the same (finite) double, as a JSON number: plain for magnitudes in [1e-6, 1e17), integers
 * without a fraction, else with an exponent ("1e-7", "1.5e300"). No NUL; returns the end. Some 25 ns. */
char *gd_number_format(char at[GD_NUMBER_SIZE], double value);

/* The same of many, in two steps: a processor has several numbers at once in each. */

/* 0.DIGITS x 10^point. */
struct gd_decimal {
    uint64_t digits; /* 17 of them, zeros behind the last one that counts; 0: the number is 0 */
    int32_t point;
    bool is_negative;
};

/* Of what is not finite they say nothing. Some 10 ns each. */
void gd_decimals(const double *values, size_t count, struct gd_decimal *out);
char *gd_decimal_format(char at[GD_NUMBER_SIZE], const struct gd_decimal *number); /* some 6 ns */

#ifdef __cplusplus
}
#endif

#endif
