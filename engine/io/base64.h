/* Base64 (RFC 4648): bytes as text, as data: URIs have them. */
#ifndef GD_IO_BASE64_H
#define GD_IO_BASE64_H

#include <stdbool.h>
#include <stddef.h>

/* Most bytes that so many characters hold. */
static inline size_t gd__base64_bytes(size_t characters)
{
    return characters / 4 * 3 + 3;
}

/* Characters, padding included, that so many bytes take. */
static inline size_t gd__base64_characters(size_t bytes)
{
    return (bytes + 2) / 3 * 4;
}

/* Reads text, with or without padding; "\/", as some JSON writers put it, is "/". `out` has room
 * for gd__base64_bytes. False: a character that is none of the alphabet. */
bool gd__base64_read(const char *text, size_t length, char *out, size_t *size);

/* Writes gd__base64_characters(size) to `out`. */
void gd__base64_write(const char *bytes, size_t size, char *out);

#endif
