#include "io/sink.h"

#include <stdlib.h>
#include <string.h>

#include "io/endian.h"
#include "gd/number.h"

#define SMALLEST_CAPACITY 1024

static void fail(struct gd__sink *sink)
{
    free(sink->bytes);
    *sink = (struct gd__sink){.failed = true};
}

/* Where `size` more bytes may be put, NULL when there is no memory for them. */
static char *room_for(struct gd__sink *sink, size_t size)
{
    if (sink->failed) return NULL;
    if (size <= sink->capacity - sink->size) return sink->bytes + sink->size;
    size_t capacity = sink->capacity < SMALLEST_CAPACITY ? SMALLEST_CAPACITY : sink->capacity + sink->capacity / 2;
    if (capacity - sink->size < size) capacity = sink->size + size;
    char *bytes = realloc(sink->bytes, capacity);
    if (!bytes) {
        fail(sink);
        return NULL;
    }
    sink->bytes = bytes;
    sink->capacity = capacity;
    return bytes + sink->size;
}

void gd__sink_bytes(struct gd__sink *sink, const void *bytes, size_t size)
{
    char *at = room_for(sink, size);
    if (!at) return;
    memcpy(at, bytes, size);
    sink->size += size;
}

void gd__sink_text(struct gd__sink *sink, const char *text)
{
    gd__sink_bytes(sink, text, strlen(text));
}

void gd__sink_integer(struct gd__sink *sink, uint64_t value)
{
    char digits[20]; /* of 2^64 - 1 */
    char *end = digits + sizeof digits, *at = end;
    do *--at = (char)('0' + value % 10);
    while (value /= 10);
    gd__sink_bytes(sink, at, (size_t)(end - at));
}

void gd__sink_double(struct gd__sink *sink, double value)
{
    char *at = room_for(sink, GD_NUMBER_SIZE);
    if (at) sink->size += (size_t)(gd_number_format(at, value) - at);
}

void gd__sink_little_endian(struct gd__sink *sink, uint64_t bits, int size)
{
    char bytes[8];
    gd__store_little_endian(bytes, bits, size);
    gd__sink_bytes(sink, bytes, (size_t)size);
}

void gd__sink_f32(struct gd__sink *sink, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    gd__sink_little_endian(sink, bits, 4);
}

void gd__sink_f64(struct gd__sink *sink, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    gd__sink_little_endian(sink, bits, 8);
}
