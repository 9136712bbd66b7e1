/* Helpers of the fuzzers of stored images. Their input is a list of patches to a real image, so
 * that most of the image stays plausible. A patch has three bytes of offset and one byte of
 * value. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "gd/mesh.h"

/* Returns a pyramid over a square, without its base. Its sides are pushed in, which makes saddles.
 * The mesh is made once. */
const struct gd_mesh *patched_surface(void);

/* Returns a copy of the image, allocated by malloc, with the input's patches. Sets *left to the
 * size of the copy. An input that begins with 255 removes bytes from the end. */
char *patched_copy(const void *image, size_t length, const uint8_t *data, size_t size,
                   size_t *left);
