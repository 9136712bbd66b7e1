/* The formats from the inside: for each, what recognises it and what reads it. One source file a
 * format. */
#ifndef GD_IO_READERS_H
#define GD_IO_READERS_H

#include "io/builder.h"
#include "io/scan.h"

/* By the size of the input, of which this is the whole. */
bool gd__stl_has_binary_size(const struct gd__scan *scan);

/* gd__obj_recognise: whether the bytes, from the cursor on, look like the format. Reads leading
 * space and comments and what follows them. gd__obj_read: adds the whole input to the builder,
 * which borrows the same scan. All errors of gd_read_polygons. */
#define GD__READER(NAME, name, media)                                                              \
    bool gd__##name##_recognise(struct gd__scan scan);                                             \
    GD_MUST_USE enum gd_status gd__##name##_read(struct gd__scan *scan,                            \
                                                 struct gd__builder *builder);
GD_FORMAT_MAP(GD__READER)
#undef GD__READER

/* gd_read_cost of a glTF; 0: it can't be read. */
size_t gd__gltf_cost(const void *bytes, size_t size, bool is_glb,
                     const struct gd_read_options *limits);

#endif
