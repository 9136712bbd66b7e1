#include "window/windows.h"

#include <stdlib.h>

/* Kernels may read one group before the first window. */
#define BEFORE ((size_t)GD__WINDOWS_GROUP * sizeof(double))

enum gd_status gd__window_builder_reserve(struct gd__window_builder *builder, uint32_t count)
{
    if (count <= builder->capacity) return GD_OK;
    uint32_t capacity = 64;
    while (capacity - GD__WINDOWS_GROUP < count) capacity *= 2;
    char *block = aligned_alloc(64, BEFORE + (size_t)capacity * GD__WINDOWS_BYTES);
    if (!block) return GD_NO_MEMORY;
    struct gd__windows at = gd__windows_at(block + BEFORE, capacity);
    if (builder->block) gd__windows_copy(&at, 0, &builder->at, 0, builder->capacity);
    free(builder->block);
    *builder = (struct gd__window_builder){
        .at = at, .capacity = capacity - GD__WINDOWS_GROUP, .block = block};
    return GD_OK;
}

void gd__window_builder_destroy(struct gd__window_builder *builder)
{
    free(builder->block);
    *builder = (struct gd__window_builder){0};
}
