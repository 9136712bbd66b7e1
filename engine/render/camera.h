/* Camera: the parallel projection of a mesh's inside to pixels. */
#ifndef GD_RENDER_CAMERA_H
#define GD_RENDER_CAMERA_H

#include "gd/picture.h"
#include "mesh/topology.h"

/* A place in the picture: pixels from its upper left corner; z, in pixels too, grows away from the
 * eye. */
struct gd__spot {
    float x, y, z;
};

/* A part of the picture, in pixels. */
struct gd__window_of_picture {
    double left, top, width, height;
};

struct gd__camera {
    struct gd_vec3 right, up, towards; /* unit vectors; `towards` the eye */
    struct gd_vec3 centre;             /* of the mesh's bounding box, inside unit */
    double scale;                      /* pixels, of a length 1 inside */
    double x, y;                       /* where the centre comes to lie */
};

/* Looks from that direction, both vectors of any length; an `up` along the line of sight leaves it
 * to the camera. The zero vector is none: `up` is y then. */
struct gd__camera gd__camera_aim(const struct gd_mesh *mesh, struct gd_vec3 towards,
                                 struct gd_vec3 up);

/* The direction from which a view of a name sees. */
struct gd_vec3 gd__view_direction(enum gd_view view, struct gd_vec3 up);

/* The direction that is `azimuth` to the right of the front and `elevation` above it, in
 * radians. */
struct gd_vec3 gd__view_from(double azimuth, double elevation, struct gd_vec3 up);

/* Moves and scales so that the surface just fills the window. O(vertices). */
void gd__camera_fit(struct gd__camera *camera, const struct gd_mesh *mesh,
                    const struct gd__window_of_picture *window);

/* Where a position inside the mesh is seen. */
struct gd__spot gd__camera_project(const struct gd__camera *camera, struct gd_vec3 position);

#endif
