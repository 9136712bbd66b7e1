/* One fuzz target for each reader: FUZZ_READER(FORMAT) defines it completely. Its input is a file
 * of that format. */
#pragma once

#include "gd/io.h"

/* Reads the bytes in that format and checks the result. GD_FORMAT_ANY first recognizes the format.
 * Aborts if an invariant is violated. Returns 0. */
int fuzz_reader(enum gd_format format, const uint8_t *data, size_t size);

#define FUZZ_READER(FORMAT)                                                                        \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);                                  \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)                                   \
    {                                                                                              \
        return fuzz_reader(GD_FORMAT_##FORMAT, data, size);                                        \
    }
