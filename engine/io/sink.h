/* Sink: bytes being written. Grows by half; once memory is out it holds nothing, takes nothing and says so at the end. */
#ifndef GD_IO_SINK_H
#define GD_IO_SINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct gd__sink {
    char *bytes;
    size_t size, capacity;
    bool failed;
};

void gd__sink_bytes(struct gd__sink *sink, const void *bytes, size_t size);
void gd__sink_text(struct gd__sink *sink, const char *text);

/* Decimal text; a double is the shortest that reads back as the same double. */
void gd__sink_integer(struct gd__sink *sink, uint64_t value);
void gd__sink_double(struct gd__sink *sink, double value);

/* The lowest `size` bytes of `bits`, and the bytes of a float or double. */
void gd__sink_little_endian(struct gd__sink *sink, uint64_t bits, int size);
void gd__sink_f32(struct gd__sink *sink, float value);
void gd__sink_f64(struct gd__sink *sink, double value);

#endif
