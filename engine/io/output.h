/* Output: a buffer to which bytes are written. It grows by half its size. After a failure (out of
 * memory, or stopped by the control) the buffer is empty, and further writes are ignored.
 * gd__output_finish reports the failure. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"

struct gd__output {
    char *bytes;
    /* `limit` is the size up to which writing needs no check of the control. limit <= capacity */
    size_t size, capacity, limit;
    const struct gd_control *control; /* NULL means no control */
    bool failed;
    enum gd_status status; /* reason of the failure; GD_OK means out of memory */
};

/* Reserves room for the first `size` bytes, on huge pages. The call is optional. Without the call,
 * a large buffer is copied each time it grows, and takes long to be freed. */
void gd__output_expect(struct gd__output *output, size_t size);

void gd__output_bytes(struct gd__output *output, const void *bytes, size_t size);
void gd__output_text(struct gd__output *output, const char *text);

/* Writes a number as decimal text. A double is written as the shortest decimal that reads back as
 * the same double. */
void gd__output_integer(struct gd__output *output, uint64_t value);
void gd__output_double(struct gd__output *output, double value);

/* Writes the lowest `size` bytes of `bits`, or the bytes of a float or double, in little-endian
 * order. */
void gd__output_little_endian(struct gd__output *output, uint64_t bits, int size);
void gd__output_f32(struct gd__output *output, float value);
void gd__output_f64(struct gd__output *output, double value);
