/* Gzip: a whole buffer at once. */
#ifndef SERVER_GZIP_H
#define SERVER_GZIP_H

#include <stddef.h>

/* Compresses `size` bytes fast rather than small. The caller frees the result; *out_size bytes. NULL without
 * memory, or when the result would be no smaller. */
void *server_gzip(const void *bytes, size_t size, size_t *out_size);

#endif
