/* Large arrays: on huge pages where the system has them, which spares most page faults and address
 * translations of scattered access. */
#ifndef GD_BASE_LARGE_H
#define GD_BASE_LARGE_H

#include <stddef.h>

/* `count` items of `size` bytes, uninitialised, 64-byte aligned, given back by free; NULL without
 * memory. Thread-safe. */
void *gd__large_array(size_t count, size_t size);

#endif
