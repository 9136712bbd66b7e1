/* Number: double <-> decimal text, correctly rounded both ways, bounded, whatever the process'
 * locale. Thread-safe. */
#ifndef GD_NUMBER_H
#define GD_NUMBER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the longest decimal number at `at`, an optional sign first. Returns its end, NULL if there
 * is none. Too large gives +-INFINITY, too small +-0; "inf" and "nan" are read as such, for the
 * caller to refuse. Some 20 ns. */
const char *gd_number_parse(const char *at, const char *end, double *out);

/* Longest text of a double: "-0.0000012345678901234567" or "-2.2250738585072014e-308". */
#define GD_NUMBER_SIZE 26

/* Writes the shortest decimal that reads back as the same (finite) double, as a JSON number: plain
 * for magnitudes in [1e-6, 1e17), integers without a fraction, else with an exponent ("1e-7",
 * "1.5e300"). No NUL; returns the end. Some 25 ns. */
char *gd_number_format(char at[GD_NUMBER_SIZE], double value);

/* The same of many, by lanes where the machine has them, each with a comma behind it; "null" for
 * what is not finite. They need that many bytes at `at`, which they may write beyond the end that
 * they return. Some 5 to 14 ns each. */
#define GD_NUMBERS_SIZE(count) ((count) * (GD_NUMBER_SIZE + 1) + 32)
char *gd_numbers_format(char *at, const double *values, size_t count);

/* As [x,y,z], each with a comma behind it. */
#define GD_TRIPLES_SIZE(count) (GD_NUMBERS_SIZE(3 * (count)) + 2 * (count))
char *gd_triples_format(char *at, const double (*values)[3], size_t count);

#ifdef __cplusplus
}
#endif

#endif
