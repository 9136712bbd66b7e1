/* SHA-256 of a buffer or of pieces, as lower-case hexadecimal. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "gd/control.h"

#define SERVER_SHA256_HEX 65 /* bytes, with the NUL */

void server_sha256(const void *bytes, size_t size, char hex[SERVER_SHA256_HEX]);

/* Returns true if the text begins with exactly 64 lower-case hexadecimal digits. */
bool server_sha256_check(const char *text);

/* Like server_sha256, but returns early at a deadline or a cancel. Also fails with GD_NO_MEMORY. */
GD_MUST_USE enum gd_status server_sha256_within(const void *bytes, size_t size,
                                                const struct gd_control *control,
                                                char hex[SERVER_SHA256_HEX]);

/* Hashes pieces, one after the other. Returns NULL if out of memory. */
struct server_sha256;
struct server_sha256 *server_sha256_begin(void);
void server_sha256_add(struct server_sha256 *sum, const void *bytes, size_t size);
void server_sha256_end(struct server_sha256 *sum, char hex[SERVER_SHA256_HEX]); /* frees it */
