#include "server/base/gzip.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <zlib.h>

#define GZIP_WINDOW 31 /* the largest window, with a gzip header */
#define GZIP_MEMORY 8
#define PIECE       16384
#define FREE_BYTES  (UINT64_C(1) << 20) /* the ratio is checked after this many bytes of output */

static bool deflate_begin(z_stream *stream)
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
    if (packer && deflate_begin(&packer->stream)) return packer;
    free(packer);
    return NULL;
}

void server_packer_destroy(struct server_packer *packer)
{
    if (!packer) return;
    deflateEnd(&packer->stream);
    free(packer);
}

void server_packer_write(struct server_packer *packer, const char *text, size_t size, bool is_last,
                         struct proto_writer *out)
{
    z_stream *stream = &packer->stream;
    unsigned char block[8192];
    do {
        stream->next_in = (Bytef *)text;
        stream->avail_in = size < UINT_MAX ? (uInt)size : UINT_MAX;
        text += stream->avail_in;
        size -= stream->avail_in;
        do { /* repeat until the block is not full, because deflate then has no more output */
            stream->next_out = block;
            stream->avail_out = sizeof block;
            /* fails only for wrong arguments, or without input */
            (void)deflate(stream, size ? Z_NO_FLUSH : is_last ? Z_FINISH : Z_SYNC_FLUSH);
            proto_append(out, (const char *)block, sizeof block - stream->avail_out);
        } while (stream->avail_out == 0 && !out->failure);
    } while (size && !out->failure);
}

bool server_gzip(const void *bytes, size_t size, struct proto_writer *out)
{
    struct server_packer packer;
    if (!deflate_begin(&packer.stream)) return false;
    server_packer_write(&packer, bytes, size, true, out);
    deflateEnd(&packer.stream);
    return !out->failure;
}

uint32_t server_crc32(uint32_t sum, const void *bytes, size_t size)
{
    return (uint32_t)crc32_z(sum, bytes, size);
}

/* --- decompression ---------------------------------------------------------------------------- */

struct server_inflater {
    z_stream stream;
    bool is_whole; /* true if the input ends between two members */
    uint64_t in, out;
};

struct server_inflater *server_inflater_create(void)
{
    struct server_inflater *inflater = calloc(1, sizeof *inflater);
    if (inflater && inflateInit2(&inflater->stream, GZIP_WINDOW) == Z_OK) return inflater;
    free(inflater);
    return NULL;
}

void server_inflater_destroy(struct server_inflater *inflater)
{
    if (!inflater) return;
    inflateEnd(&inflater->stream);
    free(inflater);
}

static enum server_inflate_outcome inflater_step(struct server_inflater *inflater,
                                                 unsigned char piece[PIECE], size_t *size)
{
    z_stream *stream = &inflater->stream;
    if (inflater->is_whole && inflateReset(stream) != Z_OK) return SERVER_INFLATE_DAMAGED;
    inflater->is_whole = false;
    uInt before = stream->avail_in;
    stream->next_out = piece;
    stream->avail_out = PIECE;
    int status = inflate(stream, Z_NO_FLUSH);
    inflater->is_whole = status == Z_STREAM_END;
    inflater->in += before - stream->avail_in;
    *size = PIECE - stream->avail_out;
    inflater->out += *size;
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
        return SERVER_INFLATE_DAMAGED;
    bool is_bomb =
        inflater->out > FREE_BYTES && inflater->out / SERVER_INFLATE_RATIO > inflater->in;
    return is_bomb ? SERVER_INFLATE_RATIO_PASSED : SERVER_INFLATE_OK;
}

enum server_inflate_outcome server_inflate(struct server_inflater *inflater, const void *bytes,
                                           size_t size,
                                           bool (*take)(void *user, const void *bytes, size_t size),
                                           void *user)
{
    unsigned char piece[PIECE];
    size_t unpacked = PIECE;
    if (size > UINT_MAX) return SERVER_INFLATE_DAMAGED;
    inflater->stream.next_in = (Bytef *)bytes;
    inflater->stream.avail_in = (uInt)size;
    while (inflater->stream.avail_in ||
           /* the piece is full, so more output may follow */
           (unpacked == PIECE && !inflater->is_whole)) {
        enum server_inflate_outcome outcome = inflater_step(inflater, piece, &unpacked);
        if (outcome != SERVER_INFLATE_OK) return outcome;
        if (unpacked && !take(user, piece, unpacked)) return SERVER_INFLATE_STOPPED;
    }
    return SERVER_INFLATE_OK;
}

bool server_inflater_is_whole(const struct server_inflater *inflater)
{
    return inflater->is_whole;
}
