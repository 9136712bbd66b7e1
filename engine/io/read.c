#include "io/readers.h"

#include <stdlib.h>
#include <string.h>

#include "io/utf16.h"

/* Returns the reader of a format; NULL means that there is no such format. */
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

static enum gd_status read_bytes(const void *bytes, size_t size, enum gd_format format,
                                 const struct gd_read_options *options, struct gd_polygons *out,
                                 struct gd_detail *detail)
{
    enum gd_status (*read)(struct gd__scan *, struct gd__builder *) = reader_of(format);
    if (!read)
        return gd_fail(
            detail, GD_UNRECOGNIZED,
            "the bytes are in none of the formats OBJ, PLY, STL, OFF, JSON, glTF and 3MF");
    struct gd__scan scan = gd__scan_begin(bytes, size, detail);
    scan.deadline_ns = options && options->control ? options->control->deadline_ns : 0;
    struct gd__builder builder = gd__builder_begin(&scan, options);
    enum gd_status status = gd__scan_end(&scan, read(&scan, &builder));
    if (status == GD_OK) status = gd__builder_finish(&builder, out);
    gd__builder_free(&builder);
    return status;
}

bool gd__is_utf16_text(const void *bytes, size_t size, enum gd_format format)
{
    struct gd__scan scan = gd__scan_begin(bytes, size, NULL);
    bool is_binary = format == GD_FORMAT_GLB || format == GD_FORMAT_GLTF ||
                     format == GD_FORMAT_PLY || format == GD_FORMAT_3MF ||
                     (format == GD_FORMAT_STL && gd__stl_has_binary_size(&scan));
    return !is_binary && gd__is_utf16(bytes, size);
}

enum gd_status gd_read_polygons(const void *bytes, size_t size,
                                const struct gd_read_options *options, struct gd_polygons *out,
                                struct gd_detail *detail)
{
    if (size == 0) return gd_fail(detail, GD_EMPTY, "the input has no bytes");
    enum gd_format format = format_of(bytes, size, options);
    if (!gd__is_utf16_text(bytes, size, format))
        return read_bytes(bytes, size, format, options, out, detail);
    char *text = NULL;
    size_t length = 0;
    enum gd_status status =
        gd__utf16_decode(bytes, size, options ? options->control : NULL, &text, &length);
    if (status == GD_NO_MEMORY) return gd_fail_status(detail, status);
    if (status != GD_OK) return status;
    status = read_bytes(text, length, format, options, out, detail);
    free(text);
    return status;
}

/* Bytes of memory per byte of a file that is read once. The ratio is largest for a triangle in STL
 * text. */
#define READ_FACTOR 8
/* Bytes of memory per byte of a file that may have triangle strips. In a strip, a corner of one
 * byte becomes a triangle of twelve bytes. */
#define STRIP_FACTOR 32

size_t gd_read_cost(const void *bytes, size_t size, const struct gd_read_options *options)
{
    enum gd_format format = format_of(bytes, size, options);
    bool has_strips = format == GD_FORMAT_PLY && memmem(bytes, size, "tristrips", 9);
    size_t once = (has_strips ? STRIP_FACTOR : READ_FACTOR) * size, placed = 0;
    if (format == GD_FORMAT_GLB || format == GD_FORMAT_GLTF)
        placed = gd__gltf_cost(bytes, size, format == GD_FORMAT_GLB, options);
    if (format == GD_FORMAT_3MF) placed = gd__3mf_cost(bytes, size, options);
    return placed > once ? placed : once;
}
