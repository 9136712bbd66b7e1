/* Helpers of the fuzzers of stored images. Their input is a list of patches (three bytes of offset,
 * one of value) to a real image, so that most of it stays plausible. */
#ifndef FUZZ_PATCHED_H
#define FUZZ_PATCHED_H

#include <stddef.h>
#include <stdint.h>

#include "gd/mesh.h"

/* Returns a pyramid over a square that is open below, with saddles where its sides are pushed in;
 * made once. */
const struct gd_mesh *patched_surface(void);

/* Returns the image with the input's patches, malloc'ed. Sets *left to its size: an input that
 * begins with 255 cuts bytes off. */
char *patched_copy(const void *image, size_t length, const uint8_t *data, size_t size,
                   size_t *left);

#endif
