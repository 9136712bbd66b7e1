/* Bounding volume hierarchy (BVH): bounding boxes over the faces. The faces are in Morton order (an
 * order in which neighbours in space get close numbers), so the tree needs no pointers. Level 0 has
 * a box for every GD_BVH_LEAF consecutive faces. Each further level has a box for every
 * GD_BVH_WIDTH boxes of the level below. The last level has a single box. */
#pragma once

#include "mesh/topology.h"

#define GD_BVH_LEAF       4
#define GD_BVH_WIDTH      4
#define GD_BVH_MAX_LEVELS 16

struct gd__construction;

struct gd__box {
    struct gd_vec3 min, max; /* normalised unit */
};

struct gd_bvh {
    struct gd__box *box;                     /* boxes, level after level */
    uint32_t level_first[GD_BVH_MAX_LEVELS]; /* index of the level's first box in `box` */
    uint32_t level_count[GD_BVH_MAX_LEVELS];
    uint32_t levels;
};

/* A search for the face with the least key. The caller defines the key, for example a distance or a
 * parameter along a ray. This struct is the first member of the caller's own struct. */
struct gd__bvh_search {
    double limit; /* boxes with a larger bound are skipped; `visit` may lower the limit */
    /* Returns a lower bound of the keys of the faces in the box, or INFINITY if the box can be
       skipped. */
    double (*bound)(const struct gd__bvh_search *search, const struct gd__box *box);
    void (*visit)(struct gd__bvh_search *search, uint32_t face);
};

/* Returns the distance of x from the interval [min, max]. */
static inline double gd__interval_distance(double x, double min, double max)
{
    return x < min ? min - x : x > max ? x - max : 0;
}

/* Returns the squared distance of a position from a box. */
static inline double gd__box_square_distance(const struct gd__box *box, struct gd_vec3 q)
{
    struct gd_vec3 d = {gd__interval_distance(q.x, box->min.x, box->max.x),
                        gd__interval_distance(q.y, box->min.y, box->max.y),
                        gd__interval_distance(q.z, box->min.z, box->max.z)};
    return gd_vec3_dot(d, d);
}

/* Visits the faces in boxes whose bounds do not exceed the limit. Visits boxes with small bounds
 * first. Thread-safe; allocates nothing. */
void gd__bvh_run(const struct gd_mesh *mesh, struct gd__bvh_search *search);

/* Returns the largest absolute coordinate of the surface, in the normalised unit. */
double gd__bvh_magnitude(const struct gd_mesh *mesh);

/* Builds the boxes: the last step of gd_mesh_build. Errors: GD_NO_MEMORY. */
enum gd_status gd__make_bvh(struct gd__construction *work);

/* Frees the boxes; NULL is allowed. */
void gd__bvh_free(struct gd_bvh *bvh);
