/* Gzip (RFC 1952): compression of a buffer or of a text in pieces, and decompression within
 * limits. */
#ifndef SERVER_BASE_GZIP_H
#define SERVER_BASE_GZIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/writer.h"

/* Compresses, fast rather than small. False without memory, or when `out` fails: its maximum limits
 * the result. */
bool server_gzip(const void *bytes, size_t size, struct proto_writer *out);

/* A text of unknown length. NULL without memory. */
struct server_packer;
struct server_packer *server_packer_create(void);
void server_packer_destroy(struct server_packer *packer); /* NULL is harmless */

/* Appends bytes from which all of the text so far can be decompressed; `is_last` ends it. Failures
 * are the writer's. */
void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out);

/* A decompressor. It limits the ratio, since a small body that grows huge is an attack (a zip
 * bomb). The input may have several members. */
struct server_inflater;

#define SERVER_INFLATE_BYTES ((size_t)48 << 10) /* that an inflater holds */
#define SERVER_INFLATE_RATIO 100 /* most bytes out for each byte in, past the first mebibyte */

enum server_inflate_outcome {
    SERVER_INFLATE_OK,
    SERVER_INFLATE_DAMAGED,
    SERVER_INFLATE_RATIO_PASSED,
    SERVER_INFLATE_STOPPED
};

/* NULL without memory. */
struct server_inflater *server_inflater_create(void);
void server_inflater_destroy(struct server_inflater *inflater); /* NULL is harmless */

/* Decompresses `size` bytes. Calls `take` with each piece; it returns false to stop. */
enum server_inflate_outcome server_inflate(struct server_inflater *inflater, const void *bytes,
                                           size_t size,
                                           bool (*take)(void *user, const void *bytes, size_t size),
                                           void *user);

/* Whether the member that was begun is complete. */
bool server_inflater_is_whole(const struct server_inflater *inflater);

/* The sum CRC-32 of what `sum` is of (0: nothing) and the bytes behind it. */
uint32_t server_crc32(uint32_t sum, const void *bytes, size_t size);

#endif
