/* A soup: polygons made from fuzzed bytes, with options for repair. Vertices lie on a coarse
 * lattice, so ties, flat parts and folds are frequent. */
#pragma once

#include "gd/mesh.h"

enum {
    SOUP_VERTICES = 24, /* each of these is a maximum */
    SOUP_FACES = 40
};

struct soup {
    double positions[SOUP_VERTICES][3];
    uint32_t corners[4 * SOUP_FACES], first[SOUP_FACES + 1];
    uint32_t vertices, faces;
    double scale; /* distance between neighbouring points of the lattice */
    struct gd_mesh_options options;
};

/* Returns the next byte, or 0 after the last byte. */
uint8_t soup_next(const uint8_t **data, size_t *size);

void soup_read(const uint8_t *data, size_t size, struct soup *soup);

/* Returns the mesh, or NULL if it is rejected. Checks that the rejection has a detail sentence. */
struct gd_mesh *soup_build(struct soup *soup);
