/* Image header: the first bytes of every binary image of data that belongs to a mesh (for example
 * of a field). They identify the kind of data, its layout and the mesh. */
#pragma once

#include "mesh/topology.h"

struct gd__image_header {
    char magic[8];
    /* version of the layout and of the internal numbering of meshes */
    uint32_t version;
    uint32_t byte_order;  /* 0x01020304; another value if the writer had another byte order */
    uint64_t fingerprint; /* identifies the mesh */
};

/* Returns the header of an image of the mesh. O(mesh). */
struct gd__image_header gd__image_header(const struct gd_mesh *mesh, const char magic[8],
                                         uint32_t version);

/* Checks the header of an image of this mesh. Errors: GD_UNRECOGNIZED (the kind, version or byte
 * order differs), GD_INVALID_ARGUMENT (the image belongs to another mesh). `detail` may be NULL.
 * O(mesh). */
GD_MUST_USE enum gd_status gd__image_header_check(const struct gd_mesh *mesh,
                                                  const struct gd__image_header *image_header,
                                                  const char magic[8], uint32_t version,
                                                  struct gd_detail *detail);
