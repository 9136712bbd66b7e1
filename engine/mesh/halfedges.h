/* OpenMesh's half-edge kernel behind a C header: corners in, numbered half-edges out. */
#ifndef GD_MESH_HALFEDGES_H
#define GD_MESH_HALFEDGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "gd/control.h"

/* Half-edges 2e and 2e+1 are the two sides of edge e; edges in order of first use by the faces. */
struct gd__halfedges {
    uint32_t edge_count;
    uint32_t failed_faces; /* that the kernel would not take: none, when edges and vertices were found to be manifold */
    uint32_t *origin;      /* per half-edge, malloc'ed */
    uint32_t *face;        /* per half-edge, malloc'ed; UINT32_MAX: boundary */
};

/* Connects `face_count` triangles over `vertex_count` vertices; `corner` is borrowed. The caller frees `*out` by
 * gd__halfedges_free. `control` is asked every few dozen faces (one that meets a vertex of a huge fan is slow to add)
 * and told fractions between `begin` and `end`. GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
enum gd_status gd__halfedges_connect(const uint32_t (*corner)[3], uint32_t face_count, uint32_t vertex_count,
                                     const struct gd_control *control, double begin, double end,
                                     struct gd__halfedges *out);

void gd__halfedges_free(struct gd__halfedges *halfedges);

#ifdef __cplusplus
}
#endif

#endif
