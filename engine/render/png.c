#include "render/image.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Writes PNG files: 8 bits, no palette, one IDAT chunk, each row with the best of three filters. */

enum {
    LEVEL = 4, /* compression level of zlib: higher levels take twice the time for a few percent */
    CHECK_INTERVAL = 4, /* rows */
    FILTERS = 3         /* number of filters that are tried: left, up, Paeth */
};

struct encoder {
    const struct gd__image *image;
    uint32_t channels, row_bytes;
    /* the previous and the current row, each with `channels` zeros in front */
    uint8_t *previous, *row;
    uint8_t *filtered[FILTERS]; /* filtered rows, each with its filter's number in front */
    uint8_t *file;              /* the chunk under construction */
    size_t used, capacity;
    z_stream stream;
};

/* --- rows ------------------------------------------------------------------------------------- */

static void read_row(const struct encoder *encoder, uint32_t y, uint8_t *out)
{
    const uint8_t(*pixel)[4] =
        (const uint8_t(*)[4])encoder->image->pixel + (size_t)y * encoder->image->width;
    for (uint32_t x = 0; x < encoder->image->width; x++)
        for (uint32_t k = 0; k < encoder->channels; k++) *out++ = pixel[x][k];
}

static uint8_t paeth(int left, int above, int corner)
{
    int guess = left + above - corner, a = abs(guess - left), b = abs(guess - above),
        c = abs(guess - corner);
    return (uint8_t)(a <= b && a <= c ? left : b <= c ? above : corner);
}

/* Filters a row by each filter, and returns the result with the least sum of absolute signed bytes,
 * because this result probably compresses best (RFC 2083, 9.6). */
static const uint8_t *filter_row(const struct encoder *encoder)
{
    static const uint8_t numbers[FILTERS] = {1, 2, 4};
    const uint8_t *row = encoder->row + encoder->channels,
                  *above = encoder->previous + encoder->channels;
    const uint8_t *left = encoder->row, *corner = encoder->previous;
    uint64_t sums[FILTERS] = {0};
    for (uint32_t i = 0; i < encoder->row_bytes; i++) {
        const uint8_t guess[FILTERS] = {left[i], above[i], paeth(left[i], above[i], corner[i])};
        for (int k = 0; k < FILTERS; k++) {
            uint8_t rest = (uint8_t)(row[i] - guess[k]);
            encoder->filtered[k][i + 1] = rest;
            sums[k] += (uint64_t)abs((int8_t)rest);
        }
    }
    int best = 0;
    for (int k = 0; k < FILTERS; k++) {
        encoder->filtered[k][0] = numbers[k];
        if (sums[k] < sums[best]) best = k;
    }
    return encoder->filtered[best];
}

/* --- chunks ----------------------------------------------------------------------------------- */

static void put_number(uint8_t *at, uint32_t number)
{
    for (int k = 0; k < 4; k++) at[k] = (uint8_t)(number >> (24 - 8 * k));
}

/* Completes the chunk that begins at `start`: writes its length and check sum. */
static void end_chunk(struct encoder *encoder, size_t start)
{
    uint8_t *chunk = encoder->file + start;
    size_t size = encoder->used - start - 8;
    put_number(chunk, (uint32_t)size);
    put_number(encoder->file + encoder->used, (uint32_t)crc32(0, chunk + 4, (uInt)(size + 4)));
    encoder->used += 4;
}

static size_t begin_chunk(struct encoder *encoder, const char name[4])
{
    size_t start = encoder->used;
    memcpy(encoder->file + start + 4, name, 4);
    encoder->used += 8;
    return start;
}

static void put_head(struct encoder *encoder)
{
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    memcpy(encoder->file, signature, sizeof signature);
    encoder->used = sizeof signature;
    size_t start = begin_chunk(encoder, "IHDR");
    uint8_t *at = encoder->file + encoder->used;
    put_number(at, encoder->image->width);
    put_number(at + 4, encoder->image->height);
    memcpy(at + 8, (const uint8_t[5]){8, encoder->channels == 3 ? 2 : 6, 0, 0, 0}, 5);
    encoder->used += 13;
    end_chunk(encoder, start);
}

/* Compresses a row. The file has room for all output of zlib. */
static void pack(struct encoder *encoder, const uint8_t *row, int flush)
{
    encoder->stream.next_in = (Bytef *)row;
    encoder->stream.avail_in = row ? encoder->row_bytes + 1 : 0;
    deflate(&encoder->stream, flush);
}

static enum gd_status put_rows(struct encoder *encoder, const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    size_t start = begin_chunk(encoder, "IDAT");
    encoder->stream.next_out = encoder->file + encoder->used;
    encoder->stream.avail_out = (uInt)(encoder->capacity - encoder->used);
    for (uint32_t y = 0; y < encoder->image->height && !status; y++) {
        read_row(encoder, y, encoder->row + encoder->channels);
        pack(encoder, filter_row(encoder), Z_NO_FLUSH);
        uint8_t *row = encoder->row;
        encoder->row = encoder->previous;
        encoder->previous = row;
        if (y % CHECK_INTERVAL == 0)
            status = gd_control_check(control, (double)y / encoder->image->height);
    }
    pack(encoder, NULL, Z_FINISH);
    encoder->used += encoder->stream.total_out;
    end_chunk(encoder, start);
    return status;
}

/* --- the file --------------------------------------------------------------------------------- */

static enum gd_status open_encoder(struct encoder *encoder, struct gd__budget *budget)
{
    enum { FRAME = 128, ZLIB = 300 << 10 };
    size_t line = encoder->row_bytes + 1 + encoder->channels, rows = (size_t)encoder->image->height;
    encoder->stream = (z_stream){0};
    if (deflateInit(&encoder->stream, LEVEL) != Z_OK) return GD_NO_MEMORY;
    encoder->capacity = deflateBound(&encoder->stream, (encoder->row_bytes + 1) * rows) + FRAME;
    enum gd_status status =
        gd__budget_take(budget, encoder->capacity + (2 + FILTERS) * line + ZLIB);
    if (status) return status;
    encoder->file = malloc(encoder->capacity);
    encoder->row = calloc(2 + FILTERS, line);
    if (!encoder->file || !encoder->row) return GD_NO_MEMORY;
    encoder->previous = encoder->row + line;
    for (int k = 0; k < FILTERS; k++) encoder->filtered[k] = encoder->row + (size_t)(2 + k) * line;
    return GD_OK;
}

enum gd_status gd__image_png(const struct gd__image *image, struct gd__budget *budget,
                             const struct gd_control *control, void **bytes, size_t *size)
{
    struct encoder encoder = {.image = image, .channels = image->is_opaque ? 3 : 4};
    encoder.row_bytes = encoder.channels * image->width;
    enum gd_status status = open_encoder(&encoder, budget);
    void *rows = encoder.row;
    if (!status) {
        put_head(&encoder);
        status = put_rows(&encoder, control);
        end_chunk(&encoder, begin_chunk(&encoder, "IEND"));
    }
    deflateEnd(&encoder.stream);
    free(rows);
    if (status) {
        free(encoder.file);
        return status;
    }
    void *fitting = realloc(encoder.file, encoder.used);
    *bytes = fitting ? fitting : encoder.file;
    *size = encoder.used;
    return GD_OK;
}
