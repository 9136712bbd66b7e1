/* Bounding boxes over the faces, which are in Morton order already: the tree needs no pointers.
 * Level 0 has a box for every GD_BVH_LEAF faces in a row, each further level one for every
 * GD_BVH_WIDTH boxes of the level below, up to a single box. */
#ifndef GD_MESH_BVH_H
#define GD_MESH_BVH_H

#include "mesh/topology.h"

#define GD_BVH_LEAF       4
#define GD_BVH_WIDTH      4
#define GD_BVH_MAX_LEVELS 16

struct gd__construction;

struct gd__box {
    struct gd_vec3 min, max; /* inside unit */
};

struct gd_bvh {
    struct gd__box *box;                     /* level after level */
    uint32_t level_first[GD_BVH_MAX_LEVELS]; /* in `box` */
    uint32_t level_count[GD_BVH_MAX_LEVELS];
    uint32_t levels;
};

/* A search for the face of least key (a distance, a ray's parameter); first member of the caller's
 * own struct. */
struct gd__bvh_search {
    double limit; /* boxes whose bound is above it are passed over; `visit` lowers it */
    /* A lower bound of the keys within the box; INFINITY: nothing of interest there. */
    double (*bound)(const struct gd__bvh_search *search, const struct gd__box *box);
    void (*visit)(struct gd__bvh_search *search, uint32_t face);
};

/* Visits the faces whose boxes may hold a key up to the limit, near boxes first. Thread-safe; no
 * memory. */
void gd__bvh_run(const struct gd_mesh *mesh, struct gd__bvh_search *search);

/* Largest absolute coordinate of the surface, inside unit. */
double gd__bvh_magnitude(const struct gd_mesh *mesh);

/* The last step of gd_mesh_build. GD_NO_MEMORY. */
enum gd_status gd__make_bvh(struct gd__construction *work);

/* NULL is harmless. */
void gd__bvh_free(struct gd_bvh *bvh);

#endif
