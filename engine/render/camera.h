/* Camera: the parallel projection of a mesh to pixels. */
#pragma once

#include "gd/picture.h"
#include "mesh/topology.h"

/* A projected point, in pixels: x and y from the upper left corner of the picture, z away from the
 * eye. */
struct gd__screen_point {
    float x, y, z;
};

/* A part of the picture, in pixels. */
struct gd__viewport {
    double left, top, width, height;
};

struct gd__camera {
    struct gd_vec3 right, up, towards; /* unit vectors; `towards` points to the eye */
    struct gd_vec3 centre;             /* centre of the mesh's bounding box, normalised unit */
    double scale;                      /* pixels per normalised unit */
    double x, y;                       /* projection of `centre`, pixels */
};

/* Aims the camera. The vectors may have any length. If `up` is zero, y is used; if `up` is along
 * the line of sight, another axis is used. */
struct gd__camera gd__camera_aim(const struct gd_mesh *mesh, struct gd_vec3 towards,
                                 struct gd_vec3 up);

/* Returns the direction towards the eye for a named view. */
struct gd_vec3 gd__view_direction(enum gd_view view, struct gd_vec3 up);

/* Returns the direction towards the eye at `azimuth` to the right of the front and `elevation`
 * above it, both in radians. */
struct gd_vec3 gd__view_from(double azimuth, double elevation, struct gd_vec3 up);

/* Moves and scales the projection so that the viewport just contains the surface and those points
 * of layers that are not far from the surface. O(vertices + points). */
void gd__camera_fit(struct gd__camera *camera, const struct gd_mesh *mesh,
                    const struct gd_picture_layer *layers, uint32_t layer_count,
                    const struct gd__viewport *window);

/* Magnifies the fitted projection, and moves the position `middle` (normalised unit) to the middle
 * of the viewport. If `middle` is NULL, the position in the middle stays there. */
void gd__camera_zoom(struct gd__camera *camera, const struct gd__viewport *window, double zoom,
                     const struct gd_vec3 *middle);

/* Projects a position of the mesh. */
struct gd__screen_point gd__camera_project(const struct gd__camera *camera,
                                           struct gd_vec3 position);
