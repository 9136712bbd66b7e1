/* Ears: triangulates one polygon by cutting off ears. Uses only diagonals that are not yet edges of
 * the mesh. */
#ifndef GD_CONSTRUCTION_EAR_H
#define GD_CONSTRUCTION_EAR_H

#include "gd/polygons.h"
#include "construction/edge_set.h"

/* Each step searches the best ear among all corners. The time is quadratic, at most about 60 ms for
 * a polygon of this size. */
#define GD_EAR_MAX_CORNERS 4096

/* Working memory for polygons of up to `most` corners. It is reused from polygon to polygon. */
struct gd__ear_clipper;

/* Allocates the working memory; free by gd__ear_clipper_free. Returns NULL if there is no
 * memory. */
struct gd__ear_clipper *gd__ear_clipper_create(uint32_t most);
void gd__ear_clipper_free(struct gd__ear_clipper *clipper);

/* Returns a vertex that occurs twice in the ring, or GD_NONE. Quadratic time. */
uint32_t gd__repeated_corner(const uint32_t *vertex, uint32_t count);

/* Triangulates the polygon of `count` >= 4 corners into count - 2 triangles that have the polygon's
 * orientation. Two vertices may occur twice: the ends of a bridge to a hole. No diagonal is an edge
 * in `edges` or has length zero. Ears inside the polygon (projected to its mean plane) are cut off
 * first, those with a good shape before others. Returns false if it finds no triangulation;
 * `triangle` is then undefined. */
bool gd__ear_clip(struct gd__ear_clipper *clipper, const double (*positions)[3],
                  const uint32_t *vertex, uint32_t count, const struct gd__edge_set *edges,
                  uint32_t (*triangle)[3]);

#endif
