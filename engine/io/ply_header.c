#include "io/ply.h"

#include <string.h>

static const struct {
    const char *name, *other_name;
    int size;
} types[] = {
#define TYPE_ENTRY(NAME, name, other, size) {#name, #other, size},
    GD__PLY_TYPE_MAP(TYPE_ENTRY)
#undef TYPE_ENTRY
};

int gd__ply_size(enum gd__ply_type type)
{
    return types[type].size;
}

/* Reads the next word, which must be a type. */
static enum gd_status read_type(struct gd__scan *scan, uint8_t *out)
{
    gd__scan_skip_blanks(scan);
    const char *place = scan->at;
    struct gd__word word = gd__scan_word(scan);
    for (size_t type = 0; type < sizeof types / sizeof types[0]; type++) {
        if (!gd__word_is(word, types[type].name) && !gd__word_is(word, types[type].other_name))
            continue;
        *out = (uint8_t)type;
        return GD_OK;
    }
    scan->at = place;
    return gd__scan_unexpected(scan, "a scalar type");
}

static enum gd_status read_format(struct gd__scan *scan, enum gd__ply_encoding *out)
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    gd__scan_skip_blanks(scan);
    const char *place = scan->at;
    struct gd__word encoding = gd__scan_word(scan);
    struct gd__word version = gd__scan_word(scan);
    for (int i = 0; i < 3; i++) {
        if (!gd__word_is(encoding, names[i])) continue;
        *out = (enum gd__ply_encoding)i;
        if (gd__word_is(version, "1.0")) return GD_OK;
        return gd__scan_fail(scan, place, GD_UNSUPPORTED, "only version 1.0 of PLY is supported");
    }
    scan->at = place;
    return gd__scan_unexpected(scan, "ascii, binary_little_endian or binary_big_endian");
}

static enum gd__ply_kind kind_of(struct gd__word name)
{
    if (gd__word_is(name, "vertex")) return GD__PLY_VERTEX;
    if (gd__word_is(name, "face")) return GD__PLY_FACE;
    if (gd__word_is(name, "tristrips")) return GD__PLY_TRISTRIPS;
    return GD__PLY_OTHER;
}

/* Reads "element <name> <count>". */
static enum gd_status read_element(struct gd__scan *scan, struct gd__ply_header *header)
{
    const char *place = scan->at;
    if (header->element_count == GD__PLY_ELEMENTS) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED, "more than %d elements",
                             GD__PLY_ELEMENTS);
    }
    struct gd__ply_element element = {.kind = kind_of(gd__scan_word(scan)),
                                      .first_property = header->property_count};
    int64_t count;
    enum gd_status status = gd__scan_integer(scan, &count);
    if (status != GD_OK) return status;
    if (count < 0)
        return gd__scan_fail(scan, place, GD_SYNTAX, "the count of an element is negative");
    for (uint32_t i = 0; i < header->element_count; i++) {
        if (element.kind != GD__PLY_OTHER && header->elements[i].kind == element.kind) {
            return gd__scan_fail(scan, place, GD_SYNTAX, "an element is declared twice");
        }
    }
    element.count = (uint64_t)count;
    header->elements[header->element_count++] = element;
    return GD_OK;
}

static bool is_corner_list(enum gd__ply_kind kind)
{
    return kind == GD__PLY_FACE || kind == GD__PLY_TRISTRIPS;
}

static enum gd__ply_role role_of(enum gd__ply_kind kind, struct gd__word name, bool list)
{
    if (kind == GD__PLY_VERTEX && !list) {
        if (gd__word_is(name, "x")) return GD__PLY_X;
        if (gd__word_is(name, "y")) return GD__PLY_Y;
        if (gd__word_is(name, "z")) return GD__PLY_Z;
    }
    if (is_corner_list(kind) && list &&
        (gd__word_is(name, "vertex_indices") || gd__word_is(name, "vertex_index"))) {
        return GD__PLY_CORNERS;
    }
    return GD__PLY_SKIPPED;
}

/* Reads "property <type> <name>" or "property list <count type> <item type> <name>". */
static enum gd_status read_property(struct gd__scan *scan, struct gd__ply_header *header)
{
    const char *place = scan->at;
    if (header->element_count == 0)
        return gd__scan_fail(scan, place, GD_SYNTAX, "a property before the first element");
    if (header->property_count == GD__PLY_PROPERTIES) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED, "more than %d properties",
                             GD__PLY_PROPERTIES);
    }
    struct gd__ply_property property = {.list = gd__word_is(gd__scan_word(scan), "list")};
    if (!property.list) scan->at = place;
    enum gd_status status = property.list ? read_type(scan, &property.count_type) : GD_OK;
    if (status == GD_OK) status = read_type(scan, &property.type);
    if (status != GD_OK) return status;
    if (property.list &&
        (property.count_type == GD__PLY_FLOAT || property.count_type == GD__PLY_DOUBLE)) {
        return gd__scan_fail(scan, place, GD_SYNTAX, "a list is counted by whole numbers");
    }
    struct gd__word name = gd__scan_word(scan);
    if (name.length == 0) return gd__scan_unexpected(scan, "the name of a property");
    struct gd__ply_element *element = &header->elements[header->element_count - 1];
    property.role = (uint8_t)role_of(element->kind, name, property.list);
    header->properties[header->property_count++] = property;
    element->property_count++;
    return GD_OK;
}

/* Returns true if each role from `first` to `last` belongs to exactly one property of the
 * element. */
static bool has_roles(const struct gd__ply_header *header, const struct gd__ply_element *element,
                      enum gd__ply_role first, enum gd__ply_role last)
{
    uint32_t found[GD__PLY_CORNERS + 1] = {0};
    for (uint32_t i = 0; i < element->property_count; i++)
        found[header->properties[element->first_property + i].role]++;
    for (enum gd__ply_role role = first; role <= last; role++) {
        if (found[role] != 1) return false;
    }
    return true;
}

static enum gd_status check_roles(const struct gd__scan *scan, const struct gd__ply_header *header)
{
    for (uint32_t i = 0; i < header->element_count; i++) {
        const struct gd__ply_element *element = &header->elements[i];
        if (element->kind == GD__PLY_VERTEX && !has_roles(header, element, GD__PLY_X, GD__PLY_Z)) {
            return gd__scan_fail(scan, scan->at, GD_SYNTAX,
                                 "the vertices need the scalar properties x, y and z, once each");
        }
        if (is_corner_list(element->kind) &&
            !has_roles(header, element, GD__PLY_CORNERS, GD__PLY_CORNERS)) {
            return gd__scan_fail(scan, scan->at, GD_SYNTAX,
                                 "the %s need one list property vertex_indices or vertex_index",
                                 element->kind == GD__PLY_FACE ? "faces" : "triangle strips");
        }
    }
    return GD_OK;
}

/* Returns the least number of bytes of a property; lists may be empty. In text a value is a digit
 * and a separator. */
static uint64_t smallest_size(const struct gd__ply_header *header,
                              const struct gd__ply_property *property)
{
    if (header->encoding == GD__PLY_ASCII) return 2;
    return (uint64_t)gd__ply_size(property->list ? property->count_type : property->type);
}

/* Returns true if the rest of the input is long enough for all elements of the header. */
static bool holds_declared(const struct gd__scan *scan, const struct gd__ply_header *header)
{
    /* the last line may have no line end */
    uint64_t left = gd__scan_left(scan) + (header->encoding == GD__PLY_ASCII);
    for (uint32_t i = 0; i < header->element_count; i++) {
        const struct gd__ply_element *element = &header->elements[i];
        uint64_t record = 0;
        for (uint32_t k = 0; k < element->property_count; k++) {
            record += smallest_size(header, &header->properties[element->first_property + k]);
        }
        if (record == 0) continue;
        if (element->count > left / record) return false;
        left -= element->count * record;
    }
    return true;
}

/* Skips the end of the header's last line. If the first line of the file ends with a CR alone, the
 * last line does too. An LF after this CR is not skipped, because it may be the first byte of a
 * binary body. */
static void skip_header_end(struct gd__scan *scan, bool lone_cr)
{
    if (lone_cr && scan->at < scan->end && *scan->at == '\r')
        scan->at++;
    else
        gd__scan_skip_line(scan);
}

/* Reads one line of the header. Sets `*done` at the last line. */
static enum gd_status read_statement(struct gd__scan *scan, struct gd__builder *builder,
                                     struct gd__ply_header *header, bool *formatted, bool *done)
{
    gd__scan_skip_blanks(scan);
    const char *place = scan->at;
    struct gd__word keyword = gd__scan_word(scan);
    if (gd__word_is(keyword, "comment") || gd__word_is(keyword, "obj_info")) return GD_OK;
    if (gd__word_is(keyword, "element")) return read_element(scan, header);
    if (gd__word_is(keyword, "property")) return read_property(scan, header);
    if (gd__word_is(keyword, "format")) {
        *formatted = true;
        return read_format(scan, &header->encoding);
    }
    *done = gd__word_is(keyword, "end_header");
    if (*done && !*formatted)
        return gd__scan_fail(scan, place, GD_SYNTAX, "the header has no format line");
    if (*done || gd__scan_left(scan) == 0)
        return *done ? GD_OK : gd__scan_unexpected(scan, "end_header");
    return gd__builder_skip(builder, place, GD_SYNTAX,
                            "found '%s' where element, property, comment or end_header should be",
                            gd__excerpt(keyword).text);
}

enum gd_status gd__ply_read_header(struct gd__scan *scan, struct gd__builder *builder,
                                   struct gd__ply_header *header)
{
    *header = (struct gd__ply_header){0};
    gd__scan_word(scan);
    bool lone_cr = gd__scan_left(scan) > 1 && scan->at[0] == '\r' && scan->at[1] != '\n';
    bool formatted = false, done = false;
    enum gd_status status = GD_OK;
    while (status == GD_OK && !done) {
        gd__scan_skip_line(scan);
        status = read_statement(scan, builder, header, &formatted, &done);
    }
    if (status == GD_OK) status = check_roles(scan, header);
    if (status != GD_OK) return status;
    skip_header_end(scan, lone_cr);
    if (!holds_declared(scan, header)) {
        return gd__scan_fail(scan, scan->at, GD_TRUNCATED,
                             "the header declares more elements than the %zu bytes after it can "
                             "hold; send the whole file",
                             gd__scan_left(scan));
    }
    return GD_OK;
}
