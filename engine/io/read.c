#include "io/readers.h"

/* NULL: there is no such format. */
static enum gd_status (*reader_of(enum gd_format format))(struct gd__scan *, struct gd__builder *)
{
    switch (format) {
#define READER_CASE(NAME, name, media)                                                             \
    case GD_FORMAT_##NAME:                                                                         \
        return gd__##name##_read;
        GD_FORMAT_MAP(READER_CASE)
#undef READER_CASE
    case GD_FORMAT_ANY:
        break;
    }
    return NULL;
}

static enum gd_format format_of(const void *bytes, size_t size,
                                const struct gd_read_options *options)
{
    enum gd_format format = options ? options->format : GD_FORMAT_ANY;
    return format == GD_FORMAT_ANY ? gd_format_recognise(bytes, size) : format;
}

enum gd_status gd_read_polygons(const void *bytes, size_t size,
                                const struct gd_read_options *options, struct gd_polygons *out,
                                struct gd_detail *detail)
{
    if (size == 0) return gd_fail(detail, GD_EMPTY, "the input has no bytes");
    enum gd_format format = format_of(bytes, size, options);
    enum gd_status (*read)(struct gd__scan *, struct gd__builder *) = reader_of(format);
    if (!read)
        return gd_fail(detail, GD_UNRECOGNIZED,
                       "the bytes are in none of the formats OBJ, PLY, STL, OFF, JSON and glTF");

    struct gd__scan scan = gd__scan_begin(bytes, size, detail);
    scan.deadline_ns = options && options->control ? options->control->deadline_ns : 0;
    struct gd__builder builder = gd__builder_begin(&scan, options);
    enum gd_status status = gd__scan_end(&scan, read(&scan, &builder));
    if (status == GD_OK) status = gd__builder_finish(&builder, out);
    gd__builder_free(&builder);
    return status;
}

/* bytes for each of a file whose bytes are read once: a triangle of STL text takes the most */
#define READ_FACTOR 8

size_t gd_read_cost(const void *bytes, size_t size, const struct gd_read_options *options)
{
    size_t once = READ_FACTOR * size, placed = 0;
    enum gd_format format = format_of(bytes, size, options);
    if (format == GD_FORMAT_GLB || format == GD_FORMAT_GLTF)
        placed = gd__gltf_cost(bytes, size, format == GD_FORMAT_GLB, options);
    return placed > once ? placed : once;
}
