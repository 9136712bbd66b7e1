/* Large arrays on huge pages, if the system has them. Huge pages avoid most page faults and TLB
 * misses. They also make it faster to free an array. A slow free would delay the end of a cancelled
 * call. */
#pragma once

#include <stddef.h>

#define GD__HUGE_PAGE ((size_t)2 << 20)

/* Allocates `count` items of `size` bytes, uninitialised and 64-byte aligned. The caller frees the
 * array by free. Returns NULL if there is no memory. Thread-safe. */
void *gd__large_array(size_t count, size_t size);

/* Like gd__large_array, but zeroed and aligned as by calloc. Pages are allocated at the first
 * write. */
void *gd__large_zeroed(size_t count, size_t size);

/* Requests huge pages for memory that no code has accessed yet. */
void gd__large_advise(void *array, size_t bytes);
