/* glTF writing: the state of one file. gltf_write.c writes the mesh and the lines, gltf_motion.c
 * the moving object, gltf_layers.c the layers.
 *
 * struct gd__gltf_writing has a buffer for each list of the document and one for the binary data.
 * The three files append to these buffers, and gltf_write.c joins them to a file. */
#pragma once

#include "gd/result_file.h"
#include "io/output.h"

enum { GD__GLTF_SHORT = 5123, GD__GLTF_INT = 5125, GD__GLTF_FLOAT = 5126 };
enum { GD__GLTF_VERTICES = 34962, GD__GLTF_INDICES = 34963 }; /* targets of views */

/* The counters are also the indices of the next items. A node has the index of its mesh. */
struct gd__gltf_writing {
    const struct gd_result *result;
    double origin[3]; /* subtracted from all positions */
    bool fits;        /* false if a position is too large, or the extent too small, for floats */
    uint32_t nodes, materials, views, accessors;
    /* `primitives` are those of the first mesh. The lists of nodes, materials and meshes omit their
     * first items, so each item begins with a comma. */
    struct gd__output node_list, material_list, primitives, mesh_list, animations, view_list,
        accessor_list, binary;
};

/* The smallest box around a set of positions. */
struct gd__gltf_box {
    double min[3], max[3];
};
extern const struct gd__gltf_box gd__gltf_empty_box;
void gd__gltf_widen(struct gd__gltf_box *box, const double position[3]);

/* Write a number or three numbers with their key. `key` includes its quotes, its colon and the
 * separator before it. */
void gd__gltf_member(struct gd__output *json, const char *key, uint64_t value);
void gd__gltf_triple(struct gd__output *json, const char *key, const double values[3]);

/* Writes the member baseColorFactor of an opaque colour. */
void gd__gltf_colour(struct gd__output *json, const struct gd_colour *colour);

/* Adds a view of the bytes from `begin` on. `stride` is the number of bytes from element to
 * element, which is required if several accessors share the view. If it is 0, it is not written.
 * `target` is 0 for data of an animation. */
void gd__gltf_view(struct gd__gltf_writing *writing, size_t begin, unsigned stride,
                   unsigned target);

/* Adds an accessor to a view. `end` is its type and all further members, with the closing brace. */
void gd__gltf_accessor(struct gd__gltf_writing *writing, uint32_t view, size_t offset,
                       unsigned type, uint64_t count, const char *end);

/* Writes positions and adds their accessor to the next view, which begins at `begin`. If there are
 * fewer than `least` positions, repeats the last one. */
void gd__gltf_positions(struct gd__gltf_writing *writing, size_t begin,
                        const double (*positions)[3], size_t count, size_t least);

/* gltf_motion.c: adds the object that moves along a line, with its animation, if the result has
 * poses and the line has a length. Its node must be the first one after that of the mesh. */
void gd__gltf_motion(struct gd__gltf_writing *writing);

/* gltf_layers.c: adds the layers that have content. A layer is a node with a mesh of one primitive:
 * LINES with indices, or POINTS. Their data is one view of positions and, if there are lines, one
 * view of indices. */
void gd__gltf_layers(struct gd__gltf_writing *writing);

/* gltf_layers.c: returns the number of a layer's points. */
size_t gd__gltf_layer_points(const struct gd_result_layer *layer);
