/* Accept: the media types and codings that a client accepts (RFC 9110, 12.5.1 and 12.5.3). */
#pragma once

#include <stdbool.h>

/* Returns the quality, from 0 (refused) to 1000, that the header's most specific matching range
 * assigns to `media_type` ("model/obj"). A header that is NULL or empty accepts every type with
 * quality 1000. Malformed ranges are skipped. O(length of the header). */
unsigned proto_accept_quality(const char *accept, const char *media_type);

/* Returns whether the header lists the coding ("gzip") with a quality above 0. The header may be
 * NULL. Ignores "*". O(length of the header). */
bool proto_accept_lists_coding(const char *accept, const char *coding);
