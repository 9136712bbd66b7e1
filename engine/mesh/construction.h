/* Construction: the state that the steps of gd_mesh_build share. The steps are in repair/ and
 * construction/; construction/build.c runs them.
 *
 * A step fills fields of the mesh or of the construction and returns a status. build.c frees
 * everything that a step allocates, also after a failure. Loops over elements count their
 * iterations with the pace (base/pace.h), which checks the control at intervals. If the pace
 * stopped a step, build.c returns the status of the pace, whatever the step returns. In gd__order
 * and all later steps, vertices and faces have internal numbers (topology.h). Error texts name the
 * caller's numbers. */
#pragma once

#include "base/pace.h"
#include "base/tolerance.h"
#include "mesh/topology.h"

/* Largest number of faces: the three sides of each face have 32-bit numbers. */
#define GD_MESH_MAX_FACES (1u << 30)

/* In the normalised unit. */
struct gd__face_measure {
    double double_area, shortest_edge;
};

/* The memory of an array of the mesh that a later step fills. Until then, it holds scratch arrays,
 * so the build touches fewer pages. All zero means that there is none. */
struct gd__loan {
    char *begin, *free, *end; /* scratch arrays are in [begin, free) */
};

struct gd__construction {
    const struct gd_polygons *input;    /* borrowed */
    struct gd_polygons *consumed;       /* `input`, if its arrays may be freed; otherwise NULL */
    const struct gd_polygons *polygons; /* input of the next steps: `input` or &`merged` */
    struct gd_mesh_options options;
    const struct gd_control *control; /* borrowed, may be NULL */
    struct gd_detail *detail;         /* borrowed, may be NULL */
    struct gd__pace pace;             /* pace of all loops over elements */
    struct gd_mesh *mesh;             /* owned; built in part */
    /* memory of mesh->side and of mesh->fan; gd__order allocates it */
    struct gd__loan until_sides, until_fans;

    /* The next four members are set by weld and repair. They are NULL and 0 if weld and repair
       change nothing. */
    /* for each input vertex, the vertex into which it was merged, or itself; a union-find forest */
    uint32_t *representative;
    /* the input's polygons with merged vertices; a removed polygon has no corners */
    struct gd_polygons merged;
    /* for each triangle that is left, its index in the input, ascending; NULL if repair removed no
       triangle */
    uint32_t *face_index;
    /* number of vertices that repair appended; mesh->copy_of has the originals of these copies */
    uint32_t copy_count;

    /* mesh->face_count triples of vertex indices. If the input has only triangles, and nothing is
     * merged or repaired, this is the input's own array of corners, which no step changes. */
    uint32_t (*triangle)[3];
    uint32_t (*corner)[3]; /* for each face, its vertices; counter-clockwise from gd__orient on */
    /* for side 3 f + k (from corner k of face f to corner k + 1), the same side in the neighbouring
       face, or GD_NONE if there is none */
    uint32_t *neighbour;
    uint32_t *component; /* for each face, number of its component */
    uint32_t component_count;
    uint32_t *any_corner;             /* for each vertex, the lowest 3 f + k of its corners */
    struct gd__face_measure *measure; /* for each face */
    double *edge_length;              /* for each edge; normalised unit */

    /* Progress of the build at the beginning and at the end of the current step. */
    double progress, progress_end;
};

/* Allocates a zeroed array owned by the mesh and adds its size to mesh->bytes. Returns NULL if out
 * of memory. Provides its pages, as gd__scratch_array does (gd__slices_touch). */
void *gd__mesh_array(struct gd__construction *work, size_t count, size_t size);

/* Allocates the sides and the fans of a large mesh, uninitialised, and lends their memory. A mesh
 * with sides below the size of a huge page is left unchanged. Errors: GD_NO_MEMORY. */
enum gd_status gd__lend_arrays(struct gd__construction *work);

/* Ends the loan of an array of the mesh, adds its size to mesh->bytes and provides its pages. If
 * gd__lend_arrays allocated no array, allocates it, aligned to cache lines, uninitialised. Returns
 * NULL if out of memory. */
void *gd__take_back(struct gd__construction *work, const struct gd__loan *loan, size_t count,
                    size_t size);

/* Returns an uninitialised array, which is valid until the step that ends the loan. If the loan has
 * too little room, or is NULL, allocates the array for the time of the build. Returns NULL if out
 * of memory. The caller frees the array by gd__scratch_free. */
void *gd__scratch_array(struct gd__construction *work, struct gd__loan *loan, size_t count,
                        size_t size);
void gd__scratch_free(const struct gd__construction *work, void *array); /* NULL is allowed */

/* Returns GD_BUDGET if building a mesh of that size would exceed the budget. */
enum gd_status gd__afford(const struct gd__construction *work, uint64_t faces, uint64_t vertices);

/* Returns the caller's number of a face: the input polygon that it came from. */
uint32_t gd__input_polygon(const struct gd_mesh *mesh, uint32_t face);

/* Returns the position of an input index. The index may be of a vertex that repair appended. */
static inline struct gd_vec3 gd__input_position(const struct gd__construction *work, uint32_t index)
{
    uint32_t count = work->input->position_count;
    const double *p =
        work->input->positions[index < count ? index : work->mesh->copy_of[index - count]];
    return (struct gd_vec3){p[0], p[1], p[2]};
}

static inline uint32_t gd__next_corner(uint32_t k)
{
    return k == 2 ? 0 : k + 1;
}

static inline uint32_t gd__previous_corner(uint32_t k)
{
    return k == 0 ? 2 : k - 1;
}
