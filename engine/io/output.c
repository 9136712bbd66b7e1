#include "io/output.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "io/endian.h"
#include "gd/number.h"

#define SMALLEST_CAPACITY 1024
#define LOOK_BYTES        ((size_t)1 << 18) /* bytes between two checks of the control */

static void fail(struct gd__output *output, enum gd_status status)
{
    free(output->bytes);
    *output = (struct gd__output){.failed = true, .status = status};
}

static size_t limit_of(const struct gd__output *output, size_t size)
{
    size_t step = size > LOOK_BYTES ? size : LOOK_BYTES;
    return output->control && output->capacity - output->size > step ? output->size + step
                                                                     : output->capacity;
}

static bool grow(struct gd__output *output, size_t size)
{
    size_t capacity = output->capacity < SMALLEST_CAPACITY
                          ? SMALLEST_CAPACITY
                          : output->capacity + output->capacity / 2;
    if (capacity - output->size < size) capacity = output->size + size;
    char *bytes = realloc(output->bytes, capacity);
    if (!bytes) {
        fail(output, GD_OK);
        return false;
    }
    output->bytes = bytes;
    output->capacity = capacity;
    return true;
}

/* Returns the position for `size` more bytes. NULL means that there is no memory, or the control
 * stops the call. */
static char *room_for(struct gd__output *output, size_t size)
{
    if (output->failed) return NULL;
    if (size <= output->limit - output->size) return output->bytes + output->size;
    enum gd_status status = gd_control_check(output->control, 0);
    if (status) {
        fail(output, status);
        return NULL;
    }
    if (size > output->capacity - output->size && !grow(output, size)) return NULL;
    output->limit = limit_of(output, size);
    return output->bytes + output->size;
}

void gd__output_expect(struct gd__output *output, size_t size)
{
    if (output->bytes || output->failed) return;
    output->bytes = gd__large_array(size, 1);
    if (output->bytes) output->capacity = size;
    output->limit = limit_of(output, 0);
}

void gd__output_bytes(struct gd__output *output, const void *bytes, size_t size)
{
    char *at = room_for(output, size);
    if (!at) return;
    memcpy(at, bytes, size);
    output->size += size;
}

void gd__output_text(struct gd__output *output, const char *text)
{
    gd__output_bytes(output, text, strlen(text));
}

void gd__output_integer(struct gd__output *output, uint64_t value)
{
    char digits[20]; /* 2^64 - 1 has 20 digits */
    char *end = digits + sizeof digits, *at = end;
    do *--at = (char)('0' + value % 10);
    while (value /= 10);
    gd__output_bytes(output, at, (size_t)(end - at));
}

void gd__output_double(struct gd__output *output, double value)
{
    char *at = room_for(output, GD_NUMBER_SIZE);
    if (at) output->size += (size_t)(gd_number_format(at, value) - at);
}

void gd__output_little_endian(struct gd__output *output, uint64_t bits, int size)
{
    char bytes[8];
    gd__store_little_endian(bytes, bits, size);
    gd__output_bytes(output, bytes, (size_t)size);
}

void gd__output_f32(struct gd__output *output, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    gd__output_little_endian(output, bits, 4);
}

void gd__output_f64(struct gd__output *output, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    gd__output_little_endian(output, bits, 8);
}
