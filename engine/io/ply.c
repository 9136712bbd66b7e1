/* PLY 1.0, text and binary of either byte order. Reads the vertices' x, y, z and the corner lists
 * of faces and triangle strips, and skips everything else. Elements may come in any order. In a
 * text file each record is a line. */
#include "io/ply.h"

#include "io/endian.h"
#include "io/readers.h"

/* The shortest triangle in bytes: the length of its list and three corners. Shorter faces are
 * skipped, so no memory is reserved for them. */
#define SMALLEST_TRIANGLE 4

struct ply {
    struct gd__scan *scan;
    struct gd__builder *builder;
    struct gd__ply_header header;
};

bool gd__ply_recognise(struct gd__scan scan)
{
    bool magic = gd__word_is(gd__scan_word(&scan), "ply");
    return magic && scan.at < scan.end && gd__is_newline(*scan.at);
}

static double load(const char *at, enum gd__ply_type type, bool big_endian)
{
    uint64_t bits = gd__load_unsigned(at, gd__ply_size(type), big_endian);
    switch (type) {
    case GD__PLY_CHAR:
        return (int8_t)bits;
    case GD__PLY_SHORT:
        return (int16_t)bits;
    case GD__PLY_INT:
        return (int32_t)bits;
    case GD__PLY_UCHAR:
    case GD__PLY_USHORT:
    case GD__PLY_UINT:
        return (double)bits;
    case GD__PLY_FLOAT:
        return gd__load_f32(at, big_endian);
    case GD__PLY_DOUBLE:
        return gd__load_f64(at, big_endian);
    }
    return 0;
}

static enum gd_status truncated(const struct ply *ply)
{
    return gd__scan_fail(ply->scan, ply->scan->at, GD_TRUNCATED,
                         "the input ends within a record; send the whole file");
}

static enum gd_status read_value(struct ply *ply, enum gd__ply_type type, double *out)
{
    struct gd__scan *scan = ply->scan;
    if (ply->header.encoding == GD__PLY_ASCII) return gd__scan_number(scan, out);
    size_t size = (size_t)gd__ply_size(type);
    if (size > gd__scan_left(scan)) return truncated(ply);
    *out = load(scan->at, type, ply->header.encoding == GD__PLY_BIG_ENDIAN);
    scan->at += size;
    return GD_OK;
}

/* Skips values. Skipped text is not parsed: a colour may be "nan". */
static enum gd_status skip_values(struct ply *ply, enum gd__ply_type type, uint64_t count)
{
    struct gd__scan *scan = ply->scan;
    if (ply->header.encoding != GD__PLY_ASCII) {
        uint64_t size = (uint64_t)gd__ply_size(type);
        if (count > gd__scan_left(scan) / size) return truncated(ply);
        scan->at += count * size;
        return GD_OK;
    }
    enum gd_status status = GD_OK;
    for (; count > 0 && status == GD_OK; count--) {
        if (gd__scan_word(scan).length == 0) return gd__scan_unexpected(scan, "a value");
        status = gd__builder_look(ply->builder);
    }
    return status;
}

static enum gd_status read_list_length(struct ply *ply, enum gd__ply_type type, uint64_t *out)
{
    const char *place = ply->scan->at;
    double length;
    enum gd_status status = read_value(ply, type, &length);
    if (status != GD_OK) return status;
    /* The longest list that a count type can declare has 2^32 - 1 items. */
    if (!(length >= 0 && length <= UINT32_MAX) || length != (double)(uint32_t)length) {
        return gd__scan_fail(ply->scan, place, GD_SYNTAX, "the length of a list is %g", length);
    }
    *out = (uint64_t)length;
    return GD_OK;
}

static enum gd_status read_corners(struct ply *ply, enum gd__ply_type type, uint64_t count,
                                   const char *place)
{
    enum gd_status status = GD_OK;
    for (; count > 0 && status == GD_OK; count--) {
        double index;
        status = read_value(ply, type, &index);
        if (status == GD_OK) status = gd__builder_add_index(ply->builder, index, place);
    }
    return status == GD_OK ? gd__builder_close_polygon(ply->builder, place) : status;
}

static enum gd_status add_triangle(struct gd__builder *builder, const double corners[3],
                                   const char *place)
{
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && status == GD_OK; k++)
        status = gd__builder_add_index(builder, corners[k], place);
    return status == GD_OK ? gd__builder_close_polygon(builder, place) : status;
}

/* Reads triangle strips; -1 ends a strip. Skips triangles that repeat a corner, because they only
 * connect one strip to the next. */
static enum gd_status read_strips(struct ply *ply, enum gd__ply_type type, uint64_t count,
                                  const char *place)
{
    double before[2] = {0}, corner;
    uint64_t length = 0;
    enum gd_status status = GD_OK;
    for (; count > 0 && status == GD_OK; count--) {
        status = read_value(ply, type, &corner);
        bool is_odd = length % 2 != 0;
        const double corners[3] = {before[is_odd], before[!is_odd], corner};
        bool is_triangle = length >= 2 && corner != before[0] && corner != before[1] &&
                           before[0] != before[1] && corner != -1;
        if (status == GD_OK && is_triangle) status = add_triangle(ply->builder, corners, place);
        if (status == GD_OK) status = gd__builder_look(ply->builder);
        length = corner == -1 ? 0 : length + 1;
        before[0] = before[1];
        before[1] = corner;
    }
    return status;
}

/* Reads a property. Writes a coordinate to `xyz` and corners to the builder. `place` is the
 * beginning of the record. */
static enum gd_status read_property(struct ply *ply, const struct gd__ply_element *element,
                                    const struct gd__ply_property *property, const char *place,
                                    double xyz[3])
{
    uint64_t count = 1;
    enum gd_status status =
        property->list ? read_list_length(ply, property->count_type, &count) : GD_OK;
    if (status != GD_OK) return status;
    switch (property->role) {
    case GD__PLY_X:
    case GD__PLY_Y:
    case GD__PLY_Z:
        return read_value(ply, property->type, &xyz[property->role - GD__PLY_X]);
    case GD__PLY_CORNERS:
        return element->kind == GD__PLY_FACE ? read_corners(ply, property->type, count, place)
                                             : read_strips(ply, property->type, count, place);
    default:
        return skip_values(ply, property->type, count);
    }
}

static enum gd_status end_record(struct ply *ply)
{
    struct gd__scan *scan = ply->scan;
    enum gd_status status = GD_OK;
    if (ply->header.encoding != GD__PLY_ASCII) return GD_OK;
    gd__scan_skip_blanks(scan);
    if (!gd__scan_at_line_end(scan)) {
        struct gd__scan ahead = *scan;
        status = gd__builder_skip(ply->builder, scan->at, GD_SYNTAX,
                                  "found '%s' where the end of the line should be",
                                  gd__excerpt(gd__scan_word(&ahead)).text);
        gd__scan_skip_line(scan);
    }
    gd__scan_skip_space(scan);
    return status;
}

static enum gd_status read_record(struct ply *ply, const struct gd__ply_element *element)
{
    const char *place = ply->scan->at;
    const struct gd__ply_property *properties = &ply->header.properties[element->first_property];
    double xyz[3] = {0};
    enum gd_status status = gd__builder_look(ply->builder);
    for (uint32_t i = 0; i < element->property_count && status == GD_OK; i++) {
        status = read_property(ply, element, &properties[i], place, xyz);
    }
    if (status == GD_OK && element->kind == GD__PLY_VERTEX)
        status = gd__builder_add_position(ply->builder, xyz, place);
    return status == GD_OK ? end_record(ply) : status;
}

static enum gd_status read_element(struct ply *ply, const struct gd__ply_element *element)
{
    enum gd_status status = GD_OK;
    if (element->property_count == 0) return GD_OK;
    if (element->kind == GD__PLY_VERTEX)
        status = gd__builder_reserve(ply->builder, element->count, 0);
    if (element->kind == GD__PLY_FACE) {
        uint64_t most = gd__scan_left(ply->scan) / SMALLEST_TRIANGLE;
        status =
            gd__builder_reserve(ply->builder, 0, element->count < most ? element->count : most);
    }
    for (uint64_t i = 0; i < element->count && status == GD_OK; i++)
        status = read_record(ply, element);
    return status;
}

enum gd_status gd__ply_read(struct gd__scan *scan, struct gd__builder *builder)
{
    if (!gd__ply_recognise(*scan)) return gd__scan_unexpected(scan, "a line with the word ply");
    struct ply ply = {.scan = scan, .builder = builder};
    enum gd_status status = gd__ply_read_header(scan, builder, &ply.header);
    if (status != GD_OK) return status;
    if (ply.header.encoding == GD__PLY_ASCII)
        gd__scan_skip_space(scan);
    else
        scan->by_byte = true;
    for (uint32_t i = 0; i < ply.header.element_count && status == GD_OK; i++) {
        status = read_element(&ply, &ply.header.elements[i]);
    }
    return status;
}
