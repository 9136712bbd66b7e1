/* Accept: the media types that a client accepts (RFC 9110, 12.5.1). */
#ifndef PROTO_ACCEPT_H
#define PROTO_ACCEPT_H

/* Returns the quality, from 0 (refused) to 1000, that the header's most specific matching range
 * assigns to `media_type` ("model/obj"). A header that is NULL or empty accepts every type with
 * quality 1000. Malformed ranges are skipped. O(length of the header). */
unsigned proto_accept_quality(const char *accept, const char *media_type);

#endif
