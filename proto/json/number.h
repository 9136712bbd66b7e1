/* Number: integers to text and back, and the JSON grammar of numbers. Doubles are written by
 * gd_number_format. */
#ifndef PROTO_NUMBER_H
#define PROTO_NUMBER_H

#include <stddef.h>
#include <stdint.h>

#define PROTO_INTEGER_SIZE 20

/* Writes `value` in decimal, without NUL; returns the length, at most PROTO_INTEGER_SIZE. */
size_t proto_integer_print(uint64_t value, char *out);

/* Reads a JSON number at the start of `text` (NUL-terminated): correctly rounded, nothing but the
 * JSON grammar. Returns how many characters it takes; 0, with `out` untouched, when there is none,
 * when it runs into an x, or when its magnitude is beyond the doubles. Thread-safe. */
size_t proto_number_parse(const char *text, double *out);

/* Reads decimal digits without a leading zero at the start of `text` (NUL-terminated). Returns how
 * many characters it takes; 0, with `out` untouched, when there are none or the number is beyond 64
 * bits. Thread-safe. */
size_t proto_integer_parse(const char *text, uint64_t *out);

#endif
