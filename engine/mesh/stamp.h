/* Stamp: what every image of something about a mesh begins with: of what it is, in which layout, of
 * which mesh. */
#ifndef GD_MESH_STAMP_H
#define GD_MESH_STAMP_H

#include "mesh/topology.h"

struct gd__stamp {
    char magic[8];
    /* of the image's layout and of the numbering that a mesh gives its elements */
    uint32_t version;
    uint32_t byte_order;  /* 0x01020304 on a machine like the writer's */
    uint64_t fingerprint; /* of the mesh */
};

/* O(mesh). */
struct gd__stamp gd__stamp(const struct gd_mesh *mesh, const char magic[8], uint32_t version);

/* Is it the stamp of such an image of this mesh? GD_UNRECOGNIZED (another kind, version or
 * machine), GD_INVALID_ARGUMENT (another mesh). `detail` may be NULL. O(mesh). */
GD_MUST_USE enum gd_status gd__stamp_check(const struct gd_mesh *mesh,
                                           const struct gd__stamp *stamp, const char magic[8],
                                           uint32_t version, struct gd_detail *detail);

#endif
