/* glTF writing: the state of one file, and the members of its document that every kind of content
 * has. gltf_write.c writes the file, gltf_motion.c the moving object, gltf_layers.c the layers. */
#ifndef GD_IO_GLTF_DOCUMENT_H
#define GD_IO_GLTF_DOCUMENT_H

#include "gd/result_file.h"
#include "io/output.h"

enum { GD__GLTF_SHORT = 5123, GD__GLTF_INT = 5125, GD__GLTF_FLOAT = 5126 };
enum { GD__GLTF_VERTICES = 34962, GD__GLTF_INDICES = 34963 }; /* targets of views */

struct gd__gltf_box {
    double min[3], max[3];
};
extern const struct gd__gltf_box gd__gltf_empty_box;

/* The counters are also the indices of the next items. A node has the index of its mesh. */
struct gd__gltf_writing {
    const struct gd_result *result;
    double origin[3];                             /* subtracted from all positions */
    double largest;                               /* largest distance */
    uint32_t keys;                                /* of the moving object; 0 if there is none */
    uint32_t views, accessors, primitives, nodes; /* written so far */
    uint64_t bytes;                               /* total bytes of the views written so far */
    struct gd__output *json, *binary;
};

void gd__gltf_widen(struct gd__gltf_box *box, const double (*positions)[3], size_t count);
void gd__gltf_write_positions(const struct gd__gltf_writing *writing, const double (*positions)[3],
                              size_t count);

void gd__gltf_text(struct gd__gltf_writing *writing, const char *text);

/* Write a number or three numbers with their key. `key` includes its quotes, its colon and the
 * separator before it. */
void gd__gltf_member(struct gd__gltf_writing *writing, const char *key, uint64_t value);
void gd__gltf_triple(struct gd__gltf_writing *writing, const char *key, const double values[3]);

/* Writes the member baseColorFactor of an opaque colour. */
void gd__gltf_colour(struct gd__gltf_writing *writing, const struct gd_colour *colour);

/* Writes a view. `stride` is the number of bytes from element to element, required if several
 * accessors share the view; 0 if not written. `target` is 0 for data of an animation. */
void gd__gltf_view(struct gd__gltf_writing *writing, uint64_t size, unsigned stride,
                   unsigned target);

/* Writes an accessor up to its type, which the caller writes. */
void gd__gltf_accessor_begin(struct gd__gltf_writing *writing, uint32_t view, uint64_t offset,
                             unsigned type, uint64_t count);

/* Writes the accessor of positions, `written` of them. Returns false if a position is beyond the
 * range of floats. */
bool gd__gltf_positions(struct gd__gltf_writing *writing, uint32_t view, uint64_t offset,
                        const double (*positions)[3], size_t count, size_t written);

#endif
