/* Normals for smooth shading with creases. The normal at a corner of a face is a mean of the
 * normals of faces around the vertex. It includes the faces whose normals differ from the face's
 * own normal by less than the crease angle. */
#ifndef GD_RENDER_NORMALS_H
#define GD_RENDER_NORMALS_H

#include "mesh/topology.h"

struct gd__normal {
    float x, y, z;
};

/* Fills `corners` with three normals for each face, of any length except 0, and `flat` with one
 * unit normal for each face. Around a vertex with more than 64 faces, each corner has its face's
 * own normal. O(faces). Errors: GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__normals_make(const struct gd_mesh *mesh,
                                            const struct gd_control *control,
                                            struct gd__normal *flat,
                                            struct gd__normal (*corners)[3]);

#endif
