/* UTF-16: converts UTF-16 text, which some Windows editors save, to UTF-8. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "gd/control.h"
#include "gd/status.h"

/* Returns true if the bytes begin with a UTF-16 byte order mark. */
bool gd__is_utf16(const void *bytes, size_t size);

/* Converts the text after the byte order mark. A surrogate without its other half becomes U+FFFD.
 * If the number of bytes is odd, the last byte is ignored. The caller frees `*out`, which has at
 * most 1.5 * size bytes. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__utf16_decode(const void *bytes, size_t size,
                                            const struct gd_control *control, char **out,
                                            size_t *out_size);
