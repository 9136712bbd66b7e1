/* A PNG decoder for the tests of pictures. It shares no code with the PNG writer. */
#pragma once

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "gd/picture.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

struct pixels {
    uint32_t width, height, channels;
    uint8_t *byte; /* rows of channels * width bytes; the caller frees it */
};

static inline uint32_t number_at(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static inline int guess_of(int filter, int left, int above, int corner)
{
    int p = left + above - corner, a = abs(p - left), b = abs(p - above), c = abs(p - corner);
    switch (filter) {
    case 0:
        return 0;
    case 1:
        return left;
    case 2:
        return above;
    case 3:
        return (left + above) / 2;
    default:
        return a <= b && a <= c ? left : b <= c ? above : corner;
    }
}

static inline void unfilter(struct pixels *pixels, const uint8_t *raw)
{
    size_t line = (size_t)pixels->width * pixels->channels;
    for (uint32_t y = 0; y < pixels->height; y++)
        for (size_t i = 0; i < line; i++) {
            uint8_t *at = pixels->byte + y * line + i;
            int left = i >= pixels->channels ? at[-(int)pixels->channels] : 0,
                above = y ? at[-(ptrdiff_t)line] : 0,
                corner =
                    y && i >= pixels->channels ? at[-(ptrdiff_t)line - (int)pixels->channels] : 0;
            *at = (uint8_t)(raw[y * (line + 1) + 1 + i] +
                            guess_of(raw[y * (line + 1)], left, above, corner));
        }
}

/* Decodes the file, checks every chunk's checksum, and frees the file. */
static inline struct pixels decode_png(uint8_t *file, size_t size)
{
    struct pixels pixels = {0};
    uint8_t *raw = NULL;
    uLongf raw_size = 0;
    assert_memory_equal(file, "\x89PNG\r\n\x1a\n", 8);
    for (size_t at = 8; at < size; at += 12 + number_at(file + at)) {
        uint32_t length = number_at(file + at);
        const uint8_t *data = file + at + 8;
        assert_true(at + 12 + length <= size);
        assert_int_equal(crc32(0, file + at + 4, length + 4), number_at(data + length));
        if (!memcmp(file + at + 4, "IHDR", 4)) {
            pixels.width = number_at(data);
            pixels.height = number_at(data + 4);
            assert_int_equal(data[8], 8);
            pixels.channels = data[9] == 2 ? 3 : 4;
            raw_size = (uLongf)pixels.height * (1 + pixels.width * pixels.channels);
            raw = malloc(raw_size);
        }
        if (!memcmp(file + at + 4, "IDAT", 4))
            assert_int_equal(uncompress(raw, &raw_size, data, length), Z_OK);
    }
    assert_int_equal(raw_size, (size_t)pixels.height * (1 + pixels.width * pixels.channels));
    pixels.byte = malloc((size_t)pixels.height * pixels.width * pixels.channels);
    unfilter(&pixels, raw);
    free(raw);
    free(file);
    return pixels;
}

static inline struct pixels draw(const struct gd_picture *picture)
{
    void *bytes;
    size_t size;
    check_ok(gd_picture_png(picture, NULL, &bytes, &size), NULL);
    return decode_png(bytes, size);
}

static inline const uint8_t *pixel_at(const struct pixels *pixels, uint32_t x, uint32_t y)
{
    assert_true(x < pixels->width && y < pixels->height);
    return pixels->byte + ((size_t)y * pixels->width + x) * pixels->channels;
}
