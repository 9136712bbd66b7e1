/* What the fuzzers of stored images share. Their input is a list of patches (three bytes of place,
 * one of value) to a real image, so that most of it stays plausible. */
#ifndef FUZZ_PATCHED_H
#define FUZZ_PATCHED_H

#include <stddef.h>
#include <stdint.h>

#include "gd/mesh.h"

/* A pyramid over a square that is open below, with saddles where its sides are pushed in; made
 * once. */
const struct gd_mesh *patched_surface(void);

/* The image with the input's patches, malloc'ed, and in *left how many of its bytes are left: an
 * input that begins with 255 cuts some off. */
char *patched_copy(const void *image, size_t length, const uint8_t *data, size_t size,
                   size_t *left);

#endif
