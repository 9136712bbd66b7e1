/* Large arrays: on huge pages where the system has them, which spares most page faults and address
 * translations of scattered access, and most of the time that freeing takes: a cancelled call ends
 * with that. */
#ifndef GD_BASE_LARGE_H
#define GD_BASE_LARGE_H

#include <stddef.h>

/* `count` items of `size` bytes, uninitialised, 64-byte aligned, given back by free; NULL without
 * memory. Thread-safe. */
void *gd__large_array(size_t count, size_t size);

/* The same, all zero, and aligned as calloc does it. Its memory is the system's until it is
 * written. */
void *gd__large_zeroed(size_t count, size_t size);

/* Asks for huge pages for memory that was just allocated. */
void gd__large_advise(void *array, size_t bytes);

#endif
