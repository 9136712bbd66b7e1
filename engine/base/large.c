#include "base/large.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)
#define LINE      ((size_t)64)

void *gd__large_array(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - HUGE_PAGE) / size) return NULL;
    size_t bytes = count * size, unit = bytes >= HUGE_PAGE ? HUGE_PAGE : LINE;
    void *array = aligned_alloc(unit, bytes ? (bytes + LINE - 1) & ~(LINE - 1) : LINE);
    if (array && unit == HUGE_PAGE) madvise(array, bytes & ~(HUGE_PAGE - 1), MADV_HUGEPAGE);
    return array;
}
