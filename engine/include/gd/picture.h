/* Picture: a mesh as a person would have it in a report: shaded, with a path, with the distances of
 * a field as colours and isolines.
 *
 *     const struct gd_picture picture = {
 *         .mesh = mesh, .field = field, .path = &path, .isolines = 10};
 *     void *bytes;
 *     size_t size;
 *     if (gd_picture_png(&picture, NULL, &bytes, &size) == GD_OK) {
 *         fwrite(bytes, 1, size, file);
 *         free(bytes);
 *     }
 *
 * The projection is parallel. Each pixel is an average of 16 samples of the surface; the colour of
 * a field is that of the exact distance where the pixel's part of a face lies, not interpolated
 * between vertices. Isolines are the exact ones (gd/isoline.h), to a tenth of a pixel. What of a
 * path is behind the surface is faint and dashed; what of an isoline is, is left out. In an SVG the
 * surface is an image of the picture's size, all lines and texts are vectors. engine/doc/025 tells
 * why. */
#ifndef GD_PICTURE_H
#define GD_PICTURE_H

#include "gd/field.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_PICTURE_LEAST    16   /* pixels of a side */
#define GD_PICTURE_MOST     4096 /* pixels of a side */
#define GD_PICTURE_PIXELS   ((uint32_t)3840 * 2160)
#define GD_PICTURE_ISOLINES 100 /* most of them */

/* Whence it is seen. Names are with respect to `up`: up y: the front is seen from +z, the right
 * from +x; up z: the front from -y. */
enum gd_view {
    /* iso, or if there are a path or a field's source and another view shows more of them, that
       one */
    GD_VIEW_CHOSEN,
    GD_VIEW_FRONT,
    GD_VIEW_BACK,
    GD_VIEW_LEFT,
    GD_VIEW_RIGHT,
    GD_VIEW_TOP,
    GD_VIEW_BOTTOM,
    GD_VIEW_ISO,
    GD_VIEW_DIRECTION
};

enum gd_background { GD_BACKGROUND_WHITE, GD_BACKGROUND_DARK, GD_BACKGROUND_TRANSPARENT };

/* All that is zero is the default, but for the mesh. */
struct gd_picture {
    const struct gd_mesh *mesh;   /* what follows is borrowed, too, and of this mesh */
    const struct gd_field *field; /* NULL: none */
    const struct gd_path *path;   /* NULL: none */
    uint32_t width, height;       /* pixels; 0: 800 x 600 */
    enum gd_view view;
    /* GD_VIEW_DIRECTION: from the surface to the eye, of any length but 0 */
    struct gd_vec3 direction;
    /* of any length; 0: y. Upwards in the picture, as far as it is not along the line of sight */
    struct gd_vec3 up;
    uint32_t isolines; /* about so many, at round distances; 0: none */
    bool edges;        /* the triangles' edges where they are not too dense */
    /* distances by colour, if there is a field; the length, if there is a path */
    bool legend;
    enum gd_background background;
};

/* The picture as a file, `*size` bytes at `*bytes`, which the caller frees by free. `control` may
 * be NULL.
 * Errors: GD_INVALID_ARGUMENT (a size, a number of isolines, a direction or an upwards outside what
 * is said above, or a field of another mesh), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * Cost: O(faces + pixels), and for a field the distances at the pixels. 800 x 600 of 100,000 faces:
 * engine/doc/025. Memory: about 64 bytes a face, 17 a pixel, and what isolines take.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_picture_png(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);
GD_MUST_USE enum gd_status gd_picture_svg(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);

#ifdef __cplusplus
}
#endif

#endif
