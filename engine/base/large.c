#include "base/large.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)
#define LINE      ((size_t)64)

void *gd__large_array(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - HUGE_PAGE) / size) return NULL;
    size_t bytes = count * size;
    void *array;
    if (posix_memalign(&array, bytes >= HUGE_PAGE ? HUGE_PAGE : LINE, bytes ? bytes : LINE))
        return NULL;
    if (bytes >= HUGE_PAGE) madvise(array, bytes & ~(HUGE_PAGE - 1), MADV_HUGEPAGE);
    return array;
}
