/* UTF-8: recognizes well-formed characters (RFC 3629). */
#pragma once

#include <stddef.h>

/* Returns the length of the well-formed character at the start of `text`, which has `size` > 0
 * bytes. Returns 0 for a stray or missing continuation byte, an overlong form, a surrogate, or a
 * value beyond U+10FFFF. */
size_t proto_utf8_length(const char *text, size_t size);
