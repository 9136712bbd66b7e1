/* Normals: of a surface that looks smooth where it is meant to be: at each corner of each face the
 * mean of those of the faces around the vertex that differ from the face's by less than a
 * crease. */
#ifndef GD_RENDER_NORMALS_H
#define GD_RENDER_NORMALS_H

#include "mesh/topology.h"

struct gd__normal {
    float x, y, z;
};

/* Fills three normals a face, by corner, of any length but 0. `flat`: one a face, is filled with
 * unit normals. O(faces), though not where more than 64 faces meet: those corners have their face's
 * own. GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__normals_make(const struct gd_mesh *mesh,
                                            const struct gd_control *control,
                                            struct gd__normal *flat,
                                            struct gd__normal (*corners)[3]);

#endif
