/* A fuzz target a reader: FUZZ_READER(FORMAT) is the whole of it. Its input is a file of that
 * format. */
#ifndef FUZZ_READER_H
#define FUZZ_READER_H

#include "gd/io.h"

/* Reads the bytes as that format (GD_FORMAT_ANY: recognised first) and checks what was read; aborts
 * where a promise is broken. Returns 0. */
int fuzz_reader(enum gd_format format, const uint8_t *data, size_t size);

#define FUZZ_READER(FORMAT)                                                                        \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);                                  \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)                                   \
    {                                                                                              \
        return fuzz_reader(GD_FORMAT_##FORMAT, data, size);                                        \
    }

#endif
