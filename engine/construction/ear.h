/* Ears: one polygon cut into triangles by diagonals that are not edges already. */
#ifndef GD_CONSTRUCTION_EAR_H
#define GD_CONSTRUCTION_EAR_H

#include "gd/polygons.h"
#include "construction/edge_set.h"

/* The best ear is sought among all corners each time: quadratic, some 60 ms for a polygon of this
 * size at worst. */
#define GD_EAR_MAX_CORNERS 4096

/* Working memory for polygons of up to `most` corners, used again for each. */
struct gd__ear_clipper;

/* NULL: out of memory. Free by gd__ear_clipper_free. */
struct gd__ear_clipper *gd__ear_clipper_create(uint32_t most);
void gd__ear_clipper_free(struct gd__ear_clipper *clipper);

/* Cuts the polygon of `count` >= 4 distinct vertices into count - 2 triangles in its own
 * orientation. Diagonals are neither in `edges` nor of length zero. Ears that lie inside the
 * polygon (projected to its mean plane) are taken before others, well-shaped ones first. False: no
 * such triangulation was found; `triangle` is then undefined. */
bool gd__ear_clip(struct gd__ear_clipper *clipper, const double (*positions)[3],
                  const uint32_t *vertex, uint32_t count, const struct gd__edge_set *edges,
                  uint32_t (*triangle)[3]);

#endif
