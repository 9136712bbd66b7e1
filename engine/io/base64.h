/* Base64 (RFC 4648): bytes as text, as in data: URIs. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Returns an upper bound on the number of bytes that result from decoding the characters. */
static inline size_t gd__base64_bytes(size_t characters)
{
    return characters / 4 * 3 + 3;
}

/* Returns the number of characters that encode the bytes, including padding. */
static inline size_t gd__base64_characters(size_t bytes)
{
    return (bytes + 2) / 3 * 4;
}

/* Decodes text with or without padding. Accepts "\/" for "/", because some JSON writers escape it.
 * `out` must have room for gd__base64_bytes(length). Returns false if a character is not in the
 * alphabet, or if the length is invalid. */
bool gd__base64_read(const char *text, size_t length, char *out, size_t *size);

/* Encodes the bytes. Writes gd__base64_characters(size) characters to `out`. */
void gd__base64_write(const char *bytes, size_t size, char *out);
