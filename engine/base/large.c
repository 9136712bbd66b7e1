#include "base/large.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

#define LINE ((size_t)64)

void *gd__large_array(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - GD__HUGE_PAGE) / size) return NULL;
    size_t bytes = count * size;
    void *array;
    if (posix_memalign(&array, bytes >= GD__HUGE_PAGE ? GD__HUGE_PAGE : LINE, bytes ? bytes : LINE))
        return NULL;
    gd__large_advise(array, bytes);
    return array;
}

void *gd__large_zeroed(size_t count, size_t size)
{
    void *array = calloc(count ? count : 1, size);
    if (array) gd__large_advise(array, count * size);
    return array;
}

void gd__large_advise(void *array, size_t bytes)
{
    uintptr_t first = ((uintptr_t)array + GD__HUGE_PAGE - 1) & ~(GD__HUGE_PAGE - 1);
    uintptr_t end = ((uintptr_t)array + bytes) & ~(GD__HUGE_PAGE - 1);
    if (end > first) madvise((void *)first, end - first, MADV_HUGEPAGE);
}
