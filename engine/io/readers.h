/* Readers: for each format, a function that recognises it and one that reads it. One source file
 * per format. */
#pragma once

#include "io/builder.h"
#include "io/scan.h"

/* Returns true if the scan, which must hold the whole input, has the size of a binary STL file. Up
 * to 49 bytes may follow its last triangle. ASCII text of less than 7 GiB never has this size: each
 * byte of its number of triangles is at least 9 (a tab), which means 151 million triangles. */
bool gd__stl_has_binary_size(const struct gd__scan *scan);

/* Returns true if the input is UTF-16 text that must be converted to UTF-8 for the reader of
 * `format`. */
bool gd__is_utf16_text(const void *bytes, size_t size, enum gd_format format);

/* gd__NAME_recognise returns true if the bytes from the cursor on look like the format. It skips
 * leading space and comments. gd__NAME_read adds the whole input to the builder, which borrows the
 * same scan. Errors: those of gd_read_polygons. */
#define GD__READER(NAME, name, media)                                                              \
    bool gd__##name##_recognise(struct gd__scan scan);                                             \
    GD_MUST_USE enum gd_status gd__##name##_read(struct gd__scan *scan,                            \
                                                 struct gd__builder *builder);
GD_FORMAT_MAP(GD__READER)
#undef GD__READER

/* Return the bytes of memory that reading a 3MF or glTF file takes (gd_read_cost). gd__gltf_cost
 * returns 0 for an invalid file. */
size_t gd__3mf_cost(const void *bytes, size_t size, const struct gd_read_options *options);
size_t gd__gltf_cost(const void *bytes, size_t size, bool is_glb,
                     const struct gd_read_options *limits);
