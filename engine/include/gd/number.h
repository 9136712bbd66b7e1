/* Number: conversion between doubles and decimal text, correctly rounded in both directions and
 * independent of the locale. Thread-safe. */
#ifndef GD_NUMBER_H
#define GD_NUMBER_H

#include <stddef.h>
#include <stdint.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

/* Parses the longest decimal number at `at`, with an optional sign. Returns the number's end, or
 * NULL if there is no number. A number that is too large becomes +-INFINITY, one that is too small
 * +-0. "inf" and "nan" are accepted; the caller must reject them. About 20 ns. */
const char *gd_number_parse(const char *at, const char *end, double *out);

/* Longest text of a double: "-0.0000012345678901234567" or "-2.2250738585072014e-308". */
#define GD_NUMBER_SIZE 26

/* Writes the shortest decimal that reads back as the same (finite) double, as a JSON number.
 * Numbers with a magnitude in [1e-6, 1e17) are written without an exponent, and integers among them
 * without a point. Other numbers have an exponent ("1e-7", "1.5e300"). Writes no NUL. Returns the
 * end of the text. About 25 ns. */
char *gd_number_format(char at[GD_NUMBER_SIZE], double value);

/* Writes many numbers, each followed by a comma. Uses vector instructions if available. Writes
 * "null" for a number that is not finite. `at` must have room for GD_NUMBERS_SIZE(count) bytes.
 * Bytes after the end of the text may be overwritten. Returns the end of the text. About 5 to 14 ns
 * for each number. */
#define GD_NUMBERS_SIZE(count) ((count) * (GD_NUMBER_SIZE + 1) + 32)
char *gd_numbers_format(char *at, const double *values, size_t count);

/* Like gd_numbers_format, but writes triples [x,y,z], each followed by a comma. */
#define GD_TRIPLES_SIZE(count) (GD_NUMBERS_SIZE(3 * (count)) + 2 * (count))
char *gd_triples_format(char *at, const double (*values)[3], size_t count);

GD_EXTERN_C_END

#endif
