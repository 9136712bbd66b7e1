/* Gzip (RFC 1952): compression of a buffer or a text, and decompression within limits. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/writer.h"

/* Compresses at the fastest level, up to the maximum of `out`. Returns false if out of memory. */
bool server_gzip(const void *bytes, size_t size, struct proto_writer *out);

/* Compresses a text in pieces. */
struct server_packer;
struct server_packer *server_packer_create(void);
void server_packer_destroy(struct server_packer *packer); /* NULL is allowed */

/* Compresses the next piece and flushes the output, so that the client can decompress all text sent
 * so far. `is_last` ends the text. Sets out->failure on error. */
void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out);

/* A decompressor. It limits the ratio of output to input (zip bombs), and reads all members. */
struct server_inflater;

#define SERVER_INFLATE_BYTES ((size_t)48 << 10) /* memory of an inflater */
/* largest ratio of output to input, beyond the first mebibyte of output */
#define SERVER_INFLATE_RATIO 100

enum server_inflate_outcome {
    SERVER_INFLATE_OK,
    SERVER_INFLATE_DAMAGED,
    SERVER_INFLATE_RATIO_PASSED,
    SERVER_INFLATE_STOPPED
};

/* Returns NULL if out of memory. */
struct server_inflater *server_inflater_create(void);
void server_inflater_destroy(struct server_inflater *inflater); /* NULL is allowed */

/* Decompresses `size` bytes and calls `take` with each piece. `take` returns false to stop. */
enum server_inflate_outcome server_inflate(struct server_inflater *inflater, const void *bytes,
                                           size_t size,
                                           bool (*take)(void *user, const void *bytes, size_t size),
                                           void *user);

/* Returns true if the input ended with a complete member. */
bool server_inflater_is_whole(const struct server_inflater *inflater);

/* Returns the CRC-32 of the bytes, continued from `sum`, which is 0 at the beginning. */
uint32_t server_crc32(uint32_t sum, const void *bytes, size_t size);
