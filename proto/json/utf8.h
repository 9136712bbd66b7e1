/* UTF-8: which bytes are characters (RFC 3629). */
#ifndef PROTO_UTF8_H
#define PROTO_UTF8_H

#include <stddef.h>

/* Length of the well-formed character at the start of `text`, which has `size` > 0 bytes; 0: none
 * stands there (a stray or missing continuation byte, an overlong form, a surrogate, beyond
 * U+10FFFF). */
size_t proto_utf8_length(const char *text, size_t size);

#endif
