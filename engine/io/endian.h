/* Endian: reads numbers of either byte order at any address, and writes little-endian ones. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t gd__load_unsigned(const char *at, int size, bool big_endian)
{
    uint64_t value = 0;
    for (int i = 0; i < size; i++) {
        int byte = big_endian ? i : size - 1 - i;
        value = value << 8 | (unsigned char)at[byte];
    }
    return value;
}

static inline uint32_t gd__load_u32(const char *at, bool big_endian)
{
    return (uint32_t)gd__load_unsigned(at, 4, big_endian);
}

static inline double gd__load_f32(const char *at, bool big_endian)
{
    uint32_t bits = gd__load_u32(at, big_endian);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static inline double gd__load_f64(const char *at, bool big_endian)
{
    uint64_t bits = gd__load_unsigned(at, 8, big_endian);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void gd__store_little_endian(char *at, uint64_t value, int size)
{
    for (int i = 0; i < size && i < 8; i++)
        /* `i < 8` avoids a warning where the compiler does not know `size` */
        at[i] = (char)(value >> 8 * i);
}
