/* Layers: lines and marks of a scene (gd/result_file.h) in a file of glTF. Each layer is a node
 * with a mesh of one primitive: LINES with indices, or POINTS. Layers without content are left out.
 * Their data is one view of positions and, if there are lines, one view of indices. */
#ifndef GD_IO_GLTF_LAYERS_H
#define GD_IO_GLTF_LAYERS_H

#include "io/gltf_document.h"

/* Returns the number of layers that have content. */
uint32_t gd__gltf_layer_count(const struct gd_result *result);

/* Returns the number of a layer's points. */
size_t gd__gltf_layer_points(const struct gd_result_layer *layer);

/* Write the layers' parts of the lists of the document. `material` is the index of the first
 * layer's material, `accessor` that of its first accessor. gd__gltf_layer_accessors returns false
 * if a position is beyond the range of floats. */
void gd__gltf_layer_nodes(struct gd__gltf_writing *writing);
void gd__gltf_layer_materials(struct gd__gltf_writing *writing);
void gd__gltf_layer_meshes(struct gd__gltf_writing *writing, uint32_t material, uint32_t accessor);
void gd__gltf_layer_views(struct gd__gltf_writing *writing);
bool gd__gltf_layer_accessors(struct gd__gltf_writing *writing, uint32_t view);

void gd__gltf_layer_data(const struct gd__gltf_writing *writing);

#endif
