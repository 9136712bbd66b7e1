/* Output: bytes being written. Grows by half; once memory is out, or the control ends it, it holds
 * nothing, takes nothing and says so at the end. */
#ifndef GD_IO_OUTPUT_H
#define GD_IO_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"

struct gd__output {
    char *bytes;
    /* limit: up to which it is written without a look at the control; <= capacity */
    size_t size, capacity, limit;
    const struct gd_control *control; /* NULL: none */
    bool failed;
    enum gd_status status; /* why, GD_OK: out of memory */
};

/* Makes room for the first `size` bytes at once, on huge pages: a large buffer that grows is
 * copied, and takes long to free. A hint. */
void gd__output_expect(struct gd__output *output, size_t size);

void gd__output_bytes(struct gd__output *output, const void *bytes, size_t size);
void gd__output_text(struct gd__output *output, const char *text);

/* Decimal text; a double is the shortest that reads back as the same double. */
void gd__output_integer(struct gd__output *output, uint64_t value);
void gd__output_double(struct gd__output *output, double value);

/* The lowest `size` bytes of `bits`, and the bytes of a float or double. */
void gd__output_little_endian(struct gd__output *output, uint64_t bits, int size);
void gd__output_f32(struct gd__output *output, float value);
void gd__output_f64(struct gd__output *output, double value);

#endif
