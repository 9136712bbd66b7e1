/* Picture: a shaded image of a mesh, with colours of a field's distances, isolines, a path, and
 * layers of lines and marks; or the same content as a scene in three dimensions.
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
 * The projection is parallel. Each pixel is the mean of 16 samples of the surface. Colours show the
 * exact distances at the pixels, not interpolated ones. Isolines are exact (gd/isoline.h), and are
 * drawn with an error of at most a tenth of a pixel. Hidden parts of a path are faint and dashed.
 * Hidden parts of isolines are not drawn. In an SVG file, the surface is an image of the picture's
 * size, and lines and texts are vectors. engine/doc/025 gives the reasons. */
#ifndef GD_PICTURE_H
#define GD_PICTURE_H

#include "gd/field.h"

GD_EXTERN_C_BEGIN

#define GD_PICTURE_LEAST    16   /* smallest number of pixels of a side */
#define GD_PICTURE_MOST     4096 /* largest number of pixels of a side */
#define GD_PICTURE_PIXELS   ((uint32_t)3840 * 2160)
#define GD_PICTURE_ISOLINES 100  /* largest number of isolines */
#define GD_PICTURE_LAYERS   512  /* largest number of layers */
#define GD_PICTURE_LABEL    40   /* largest number of characters of a label */
#define GD_PICTURE_LABELS   1000 /* largest number of labels of a picture */
/* width of the widest line, and radius of the largest mark, in units */
#define GD_PICTURE_WIDTH 50
/* largest distance of lines and marks from the surface, relative to the surface's size */
#define GD_PICTURE_FARTHEST 1e6
#define GD_PICTURE_ZOOM     100 /* largest zoom */

/* The direction of view, relative to `up`. With up y, the front is seen from +z and the right from
 * +x; with up z, the front from -y. */
enum gd_view {
    /* GD_VIEW_ISO, or another view if it shows more of the path or of the field's source */
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

/* A colour 0xRRGGBB (sRGB). The value 0 selects the default colour. An additional bit is set in all
 * other values, so that black differs from the default. */
#define GD_PICTURE_RGB(rgb) ((uint32_t)(rgb) | UINT32_C(1) << 24)

/* How to draw the parts of lines and marks that are behind the surface. */
enum gd_hidden { GD_HIDDEN_FAINT, GD_HIDDEN_NONE, GD_HIDDEN_SHOWN };

enum gd_line_ends {
    GD_LINE_ENDS_NONE,
    GD_LINE_ENDS_MARKS, /* a ring where the first line begins, a disc where the last line ends */
    GD_LINE_ENDS_ARROWS /* a head at the end of each line */
};

/* Polylines that are drawn with one pen, or marks, which are discs with labels. They may lie on the
 * surface or elsewhere in space. All members except the points may be zero, which means the
 * defaults. Widths of lines and radii of marks are in units. A unit is one pixel in a picture of
 * 800 x 600 pixels, and grows with the size of the picture. */
struct gd_picture_layer {
    const struct gd_vec3 *points; /* positions in the caller's unit, borrowed */
    /* For lines: count + 1 ascending items; line i has the points first[i] to first[i + 1] - 1.
       NULL means that the points are marks. */
    const uint32_t *first;
    uint32_t count; /* number of lines or marks */
    /* For each mark, a text of printable ASCII, or NULL if the mark has no label. The array is NULL
       if no mark has a label. */
    const char *const *labels;
    uint32_t id; /* number of the layer's group in an SVG file */
    /* text of printable ASCII in the legend; NULL means that the legend omits the layer */
    const char *name;
    uint32_t colour; /* GD_PICTURE_RGB; 0 means a different colour for each layer */
    /* width of lines, where 0 means 3 for one line and 1.6 for several; or radius of marks, where 0
       means 4.2 */
    double width;
    enum gd_hidden hidden;
    enum gd_line_ends ends; /* ends of lines */
};

/* All members except the mesh may be zero, which means the defaults. */
struct gd_picture {
    /* The mesh, the field, the path and all arrays are borrowed. The field and the path belong to
       this mesh. */
    const struct gd_mesh *mesh;
    const struct gd_field *field; /* NULL means none */
    /* drawn like a layer, before `layers`; NULL means none */
    const struct gd_path *path;
    const struct gd_picture_layer *layers; /* drawn in the order of the array */
    uint32_t layer_count;
    uint32_t width, height; /* pixels; 0 means 800 x 600 */
    enum gd_view view;
    /* for GD_VIEW_DIRECTION, the vector from the surface to the eye, of any length except 0 */
    struct gd_vec3 direction;
    /* Upward direction in the picture, of any length; 0 means y. The component along the line of
       sight is ignored. */
    struct gd_vec3 up;
    double zoom; /* at least 1; with 1 the whole surface just fits into the picture; 0 means 1 */
    /* for a zoom above 1, the position in the middle of the picture, in the caller's unit; NULL
       means the middle of the surface */
    const struct gd_vec3 *target;
    uint32_t isolines; /* approximate number of isolines, at round distances; 0 means none */
    /* distances of isolines, which replace `isolines`; may be NULL */
    const double *levels;
    uint32_t level_count;
    double isoline_width;                    /* in units; 0 means 1 */
    uint32_t isoline_colour, surface_colour; /* GD_PICTURE_RGB; 0 means the default */
    bool edges; /* true if the triangles' edges are drawn, where they are not too dense */
    /* true if a legend is drawn: a colour scale of distances if there is a field, the length if
       there is a path, and the names of layers */
    bool legend;
    enum gd_background background;
};

/* Render the picture as a PNG or SVG file: `*size` bytes at `*bytes`, which the caller frees by
 * free. `control` may be NULL. Errors: GD_INVALID_ARGUMENT (a member is out of range, or the field
 * belongs to another mesh), GD_BEYOND_REACH (a level exceeds the reach of a partial field),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: O(faces + pixels + points of layers),
 * and for a field the distances at the pixels; engine/doc/025 has measured times. Memory: about 64
 * bytes a face, 17 a pixel, the isolines, and 40 bytes for each pixel that the longest line
 * crosses. Thread-safe. */
GD_MUST_USE enum gd_status gd_picture_png(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);
GD_MUST_USE enum gd_status gd_picture_svg(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);

/* Writes the picture as a scene in three dimensions: a GLB file as in gd/result_file.h. The surface
 * is coloured by the distances of its vertices, or has the picture's colour. The isolines are the
 * node `isolines`, the path is the node `path`, and a layer is the node `layer-` with its id, or
 * several of them. Polylines of isolines differ from the isolines by at most 1e-4 of the surface's
 * diagonal. View, size, widths, ends, hidden parts and the legend have no effect. Errors: those of
 * gd_picture_png; GD_EXTENT (too large or too small for floats), GD_TOO_LARGE (4 GiB). Memory:
 * about 500 bytes a vertex. */
GD_MUST_USE enum gd_status gd_picture_glb(const struct gd_picture *picture,
                                          const struct gd_control *control, void **bytes,
                                          size_t *size);

GD_EXTERN_C_END

#endif
