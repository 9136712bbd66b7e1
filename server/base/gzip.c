/* See gzip.h. */
#include "server/base/gzip.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

#define GZIP_WINDOW 31 /* the largest window, with a gzip header */
#define GZIP_MEMORY 8

static bool begin(z_stream *stream)
{
    *stream = (z_stream){0};
    return deflateInit2(stream, Z_BEST_SPEED, Z_DEFLATED, GZIP_WINDOW, GZIP_MEMORY,
                        Z_DEFAULT_STRATEGY) == Z_OK;
}

struct server_packer {
    z_stream stream;
};

struct server_packer *server_packer_create(void)
{
    struct server_packer *packer = malloc(sizeof *packer);
    if (packer && begin(&packer->stream)) return packer;
    free(packer);
    return NULL;
}

void server_packer_destroy(struct server_packer *packer)
{
    if (!packer) return;
    deflateEnd(&packer->stream);
    free(packer);
}

/* Packs at most UINT_MAX bytes; deflate has written all when it leaves room. */
static void pack(z_stream *stream, int flush, struct proto_writer *out)
{
    unsigned char block[8192];
    do {
        stream->next_out = block;
        stream->avail_out = sizeof block;
        /* fails only at wrong arguments, or if there is nothing to do */
        (void)deflate(stream, flush);
        proto_append(out, (const char *)block, sizeof block - stream->avail_out);
    } while (stream->avail_out == 0 && !out->failure);
}

void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out)
{
    z_stream *stream = &packer->stream;
    do {
        stream->next_in = (Bytef *)text;
        stream->avail_in = size < UINT_MAX ? (uInt)size : UINT_MAX;
        text += stream->avail_in;
        size -= stream->avail_in;
        pack(stream, size ? Z_NO_FLUSH : is_last ? Z_FINISH : Z_SYNC_FLUSH, out);
    } while (size && !out->failure);
}

bool server_gzip(const void *bytes, size_t size, struct proto_writer *out)
{
    struct server_packer packer;
    if (!begin(&packer.stream)) return false;
    server_packer_write(&packer, bytes, size, true, out);
    deflateEnd(&packer.stream);
    return !out->failure;
}
