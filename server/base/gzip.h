/* Gzip: a whole buffer at once, or a text as it comes. */
#ifndef SERVER_BASE_GZIP_H
#define SERVER_BASE_GZIP_H

#include <stdbool.h>
#include <stddef.h>

#include "proto/writer.h"

/* Compresses `size` bytes fast rather than small. False without memory, or when `out` fails, whose
 * maximum tells how small the result is to be. */
bool server_gzip(const void *bytes, size_t size, struct proto_writer *out);

/* A text of unknown length. NULL without memory. */
struct server_packer;
struct server_packer *server_packer_create(void);
void server_packer_destroy(struct server_packer *packer); /* NULL is harmless */

/* Appends what makes all of the text so far readable; `is_last`: and the end. A failure is the
 * writer's. */
void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out);

#endif
