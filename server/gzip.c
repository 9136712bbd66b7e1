/* See gzip.h. */
#include "server/gzip.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

#define GZIP_WINDOW 31 /* the largest window, with a gzip header */
#define GZIP_MEMORY 8

void *server_gzip(const void *bytes, size_t size, size_t *out_size)
{
    if (size > UINT_MAX) return NULL;
    z_stream stream = {0};
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, GZIP_WINDOW, GZIP_MEMORY, Z_DEFAULT_STRATEGY) != Z_OK)
        return NULL;
    void *out = malloc(size);
    int status = Z_MEM_ERROR;
    if (out) {
        stream.next_in = (Bytef *)bytes;
        stream.avail_in = (uInt)size;
        stream.next_out = out;
        stream.avail_out = (uInt)size;
        status = deflate(&stream, Z_FINISH);
        *out_size = stream.total_out;
    }
    deflateEnd(&stream);
    if (status == Z_STREAM_END) return out;
    free(out);
    return NULL;
}
