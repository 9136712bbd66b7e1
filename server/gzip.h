/* Gzip: a whole buffer at once, or a text as it comes. */
#ifndef SERVER_GZIP_H
#define SERVER_GZIP_H

#include <stdbool.h>
#include <stddef.h>

#include "proto/writer.h"

/* Compresses `size` bytes fast rather than small. The caller frees the result; *out_size bytes. NULL without
 * memory, or when the result would be no smaller. */
void *server_gzip(const void *bytes, size_t size, size_t *out_size);

/* A text of unknown length. NULL without memory. */
struct server_packer;
struct server_packer *server_packer_create(void);
void server_packer_destroy(struct server_packer *packer); /* NULL is harmless */

/* Appends what makes all of the text so far readable; `is_last`: and the end. A failure is the writer's. */
void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out);

#endif
