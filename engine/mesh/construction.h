/* Construction: the state that the steps of gd_mesh_build share. The steps are in repair/ and
 * construction/; construction/build.c runs them.
 *
 * A step fills fields of the mesh or of the construction and returns a status. build.c frees what a
 * step allocates, also after a failure. Loops over elements step the pace; a step that was stopped
 * may return any status, build.c replaces it by that of the pace. From gd__order on, vertices and
 * faces have internal numbers (topology.h); errors name the caller's numbers. */
#ifndef GD_MESH_CONSTRUCTION_H
#define GD_MESH_CONSTRUCTION_H

#include "base/pace.h"
#include "base/tolerance.h"
#include "mesh/topology.h"

/* Three sides a face are numbered in 32 bits. */
#define GD_MESH_MAX_FACES (1u << 30)

struct gd__construction {
    const struct gd_polygons *input;    /* borrowed */
    const struct gd_polygons *polygons; /* of the next steps: the input, or `merged` */
    struct gd_mesh_options options;
    const struct gd_control *control; /* borrowed, may be NULL */
    struct gd_detail *detail;         /* borrowed, may be NULL */
    struct gd__pace pace;             /* of all loops over elements */
    struct gd_mesh *mesh;             /* half-built, owned */

    /* Made by weld and repair; NULL and 0 if they changed nothing. */
    /* per input vertex: the one that it was merged into, itself if none */
    uint32_t *representative;
    /* the input's polygons by representatives; what is left of some has no corners */
    struct gd_polygons merged;
    /* per triangle: its index, ascending; NULL: triangle i has index i */
    uint32_t *face_index;
    uint32_t copy_count; /* of vertices; mesh->copy_of holds what they are copies of */

    uint32_t (*triangle)[3]; /* mesh->face_count: vertex indices */
    uint32_t (*corner)[3];   /* per face: vertices; counter-clockwise from gd__orient on */
    /* per face side 3 f + k, from corner k to k + 1: that side in the face across, or GD_NONE */
    uint32_t *neighbour;
    uint32_t *component; /* per face */
    uint32_t component_count;

    /* Parts of the whole work done before and after the current step, for reports within it. */
    double begun, until;
};

/* Zeroed array that the mesh will own, counted in mesh->bytes; NULL: out of memory. */
void *gd__mesh_array(struct gd_mesh *mesh, size_t count, size_t size);

/* The same for sides, aligned to their cache line and not zeroed. */
struct gd_side *gd__mesh_sides(struct gd_mesh *mesh, size_t count);

/* GD_BUDGET if building so large a mesh would exceed the budget. */
enum gd_status gd__afford(const struct gd__construction *work, uint64_t faces, uint64_t vertices);

/* The caller's number of a face: the input polygon that it came from. */
uint32_t gd__input_polygon(const struct gd_mesh *mesh, uint32_t face);

static inline uint32_t gd__next_corner(uint32_t k)
{
    return k == 2 ? 0 : k + 1;
}

static inline uint32_t gd__previous_corner(uint32_t k)
{
    return k == 0 ? 2 : k - 1;
}

#endif
