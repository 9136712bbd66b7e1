/* Picture: a shaded image of a mesh, with a path, colours of a field's distances, and isolines.
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
 * The projection is parallel. Each pixel averages 16 samples of the surface. Colours show exact
 * distances at the pixels, not interpolated ones. Isolines are exact (gd/isoline.h), to a tenth of
 * a pixel. Hidden parts of a path are faint and dashed; hidden parts of isolines are left out. In
 * an SVG the surface is an image of the picture's size; lines and texts are vectors. engine/doc/025
 * gives the reasons. */
#ifndef GD_PICTURE_H
#define GD_PICTURE_H

#include "gd/field.h"

GD_EXTERN_C_BEGIN

#define GD_PICTURE_LEAST    16   /* pixels of a side */
#define GD_PICTURE_MOST     4096 /* pixels of a side */
#define GD_PICTURE_PIXELS   ((uint32_t)3840 * 2160)
#define GD_PICTURE_ISOLINES 100 /* largest number of isolines */

/* The direction of view, relative to `up`. With up y, the front is seen from +z and the right from
 * +x; with up z, the front from -y. */
enum gd_view {
    /* GD_VIEW_ISO, or another view that shows more of the path or of the field's source */
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

/* All zero is the default, except for the mesh. */
struct gd_picture {
    /* Borrowed, as are `field` and `path`, which belong to this mesh. */
    const struct gd_mesh *mesh;
    const struct gd_field *field; /* NULL: none */
    const struct gd_path *path;   /* NULL: none */
    uint32_t width, height;       /* pixels; 0: 800 x 600 */
    enum gd_view view;
    /* GD_VIEW_DIRECTION: from the surface to the eye, of any length except 0 */
    struct gd_vec3 direction;
    /* Upward direction in the picture, of any length; 0: y. The component along the line of sight
       is ignored. */
    struct gd_vec3 up;
    uint32_t isolines; /* about this many, at round distances; 0: none */
    bool edges;        /* draws the triangles' edges where they are not too dense */
    /* draws a colour scale of distances if there is a field, and the length if there is a path */
    bool legend;
    enum gd_background background;
};

/* Render the picture as a PNG or SVG file: `*size` bytes at `*bytes`, which the caller frees by
 * free. `control` may be NULL. Errors: GD_INVALID_ARGUMENT (a size, a number of isolines, a
 * direction or `up` out of range, or a field of another mesh), GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. Cost: O(faces + pixels), and for a field the distances at the pixels;
 * for figures see engine/doc/025. Memory: about 64 bytes a face, 17 a pixel, and the isolines.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_picture_png(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);
GD_MUST_USE enum gd_status gd_picture_svg(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);

GD_EXTERN_C_END

#endif
