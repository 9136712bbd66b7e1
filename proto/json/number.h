/* Number: conversion between integers and text, and the JSON grammar of numbers. gd_number_format
 * writes doubles. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define PROTO_INTEGER_SIZE 20

/* Writes `value` in decimal, without NUL; returns the length, at most PROTO_INTEGER_SIZE. */
size_t proto_integer_print(uint64_t value, char *out);

/* Reads a JSON number at the start of `text` (NUL-terminated), correctly rounded. Returns the
 * number's length in characters. Returns 0, with `out` untouched, if there is no number, if the
 * letter x follows the number (as in 0x10), or if its magnitude exceeds the range of doubles.
 * Thread-safe. */
size_t proto_number_parse(const char *text, double *out);

/* Reads decimal digits without a leading zero at the start of `text` (NUL-terminated). Returns the
 * number of digits. Returns 0, with `out` untouched, if there are none or the value exceeds 64
 * bits. Thread-safe. */
size_t proto_integer_parse(const char *text, uint64_t *out);
