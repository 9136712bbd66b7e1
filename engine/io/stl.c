/* STL (stereolithography), text and binary. The file has separate triangles; equal corners are
 * welded. Normals and attributes are skipped.
 *
 * Binary files may also begin with "solid", and may have bytes behind their last triangle. So the
 * input is binary in three cases: it has room for exactly the declared number of triangles, it does
 * not begin with "solid", or it has a NUL where text cannot have one. */
#include "io/readers.h"

#include <string.h>

#include "io/endian.h"
#include "io/weld.h"

#define HEADER_SIZE   80
#define PREAMBLE_SIZE 84 /* bytes of the header and of the number of facets */
#define NORMAL_SIZE   12
#define TRIANGLE_SIZE 50

struct stl {
    struct gd__scan *scan;
    struct gd__builder *builder;
    struct gd__weld weld;
};

static size_t size_of(const struct gd__scan *scan)
{
    return (size_t)(scan->end - scan->begin);
}

/* Returns the number of triangles from the preamble. The input must have a preamble. */
static uint32_t declared_triangles(const struct gd__scan *scan)
{
    return gd__load_u32(scan->begin + HEADER_SIZE, false);
}

bool gd__stl_has_binary_size(const struct gd__scan *scan)
{
    size_t size = size_of(scan);
    if (size <= PREAMBLE_SIZE) return size == PREAMBLE_SIZE && declared_triangles(scan) == 0;
    size_t triangles = (size - PREAMBLE_SIZE) / TRIANGLE_SIZE;
    return triangles > 0 && triangles == declared_triangles(scan);
}

static bool begins_solid(struct gd__scan scan)
{
    gd__scan_skip_space(&scan);
    return gd__word_resembles(gd__scan_word(&scan), "solid");
}

static bool is_text(const struct gd__scan *scan)
{
    size_t head = size_of(scan) < PREAMBLE_SIZE ? size_of(scan) : PREAMBLE_SIZE;
    return !gd__stl_has_binary_size(scan) && begins_solid(*scan) &&
           !memchr(scan->begin, '\0', head);
}

bool gd__stl_recognise(struct gd__scan scan)
{
    return gd__stl_has_binary_size(&scan) || begins_solid(scan);
}

static enum gd_status add_corner(struct stl *stl, const double xyz[3], const char *place)
{
    uint32_t vertex;
    enum gd_status status = gd__weld_vertex(&stl->weld, xyz, place, &vertex);
    return status == GD_OK ? gd__builder_add_corner(stl->builder, vertex, place) : status;
}

static enum gd_status read_binary_triangle(struct stl *stl)
{
    struct gd__scan *scan = stl->scan;
    const char *place = scan->at, *corner = place + NORMAL_SIZE;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && status == GD_OK; k++, corner += 12) {
        double xyz[3];
        for (int axis = 0; axis < 3; axis++) xyz[axis] = gd__load_f32(corner + 4 * axis, false);
        status = add_corner(stl, xyz, place);
    }
    scan->at += TRIANGLE_SIZE;
    return status == GD_OK ? gd__builder_close_polygon(stl->builder, place) : status;
}

static enum gd_status read_binary(struct stl *stl)
{
    struct gd__scan *scan = stl->scan;
    scan->by_byte = true;
    if (size_of(scan) < PREAMBLE_SIZE) {
        return gd__scan_fail(
            scan, scan->end, GD_TRUNCATED,
            "neither text that begins with 'solid' nor the %d bytes that begin binary STL",
            PREAMBLE_SIZE);
    }
    uint32_t triangles = declared_triangles(scan);
    scan->at = scan->begin + PREAMBLE_SIZE;
    if (triangles > gd__scan_left(scan) / TRIANGLE_SIZE) {
        return gd__scan_fail(
            scan, scan->begin + HEADER_SIZE, GD_TRUNCATED,
            "%u triangles are declared, but only %zu bytes follow; send the whole file", triangles,
            gd__scan_left(scan));
    }
    enum gd_status status = gd__builder_reserve(stl->builder, 0, triangles);
    for (uint32_t i = 0; status == GD_OK && i < triangles; i++) status = read_binary_triangle(stl);
    return status;
}

static enum gd_status expect_word(struct gd__scan *scan, const char *text)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    if (gd__word_resembles(gd__scan_word(scan), text)) return GD_OK;
    scan->at = place;
    return gd__scan_unexpected(scan, text);
}

static enum gd_status read_text_corner(struct stl *stl)
{
    enum gd_status status = expect_word(stl->scan, "vertex");
    const char *place = stl->scan->at;
    double xyz[3];
    if (status == GD_OK) status = gd__scan_xyz(stl->scan, xyz);
    return status == GD_OK ? add_corner(stl, xyz, place) : status;
}

/* Skips the normal of a facet: the words up to "outer" or to the end of the line. */
static void skip_normal(struct gd__scan *scan)
{
    struct gd__scan ahead = *scan;
    for (struct gd__word word = gd__scan_word(&ahead);
         word.length > 0 && !gd__word_resembles(word, "outer"); word = gd__scan_word(&ahead))
        scan->at = ahead.at;
}

/* Reads a facet. The cursor is after the word "facet". Leaves the cursor after "endfacet". */
static enum gd_status read_text_facet(struct stl *stl)
{
    struct gd__scan *scan = stl->scan;
    const char *place = scan->at;
    skip_normal(scan);
    enum gd_status status = expect_word(scan, "outer");
    if (status == GD_OK) status = expect_word(scan, "loop");
    for (int k = 0; k < 3 && status == GD_OK; k++) status = read_text_corner(stl);
    if (status == GD_OK) status = expect_word(scan, "endloop");
    if (status == GD_OK) status = expect_word(scan, "endfacet");
    return status == GD_OK ? gd__builder_close_polygon(stl->builder, place) : status;
}

/* Reads a solid. The cursor is after the word "solid"; the rest of this line is the name, which is
 * skipped. Leaves the cursor after the line of "endsolid". */
static enum gd_status read_text_solid(struct stl *stl)
{
    struct gd__scan *scan = stl->scan;
    gd__scan_skip_line(scan);
    for (;;) {
        gd__scan_skip_space(scan);
        const char *place = scan->at;
        struct gd__word word = gd__scan_word(scan);
        if (gd__word_resembles(word, "endsolid")) break;
        if (!gd__word_resembles(word, "facet")) {
            scan->at = place;
            return gd__scan_unexpected(scan, "facet or endsolid");
        }
        enum gd_status status = read_text_facet(stl);
        if (status != GD_OK) return status;
    }
    gd__scan_skip_line(scan);
    return GD_OK;
}

static enum gd_status read_text(struct stl *stl)
{
    struct gd__scan *scan = stl->scan;
    enum gd_status status = GD_OK;
    for (gd__scan_skip_space(scan); status == GD_OK && scan->at < scan->end;
         gd__scan_skip_space(scan)) {
        status = expect_word(scan, "solid");
        if (status == GD_OK) status = read_text_solid(stl);
        if (status == GD_OK) status = gd__builder_look(stl->builder);
    }
    return status;
}

enum gd_status gd__stl_read(struct gd__scan *scan, struct gd__builder *builder)
{
    struct stl stl = {.scan = scan, .builder = builder, .weld = gd__weld_begin(builder)};
    enum gd_status status = is_text(scan) ? read_text(&stl) : read_binary(&stl);
    gd__weld_free(&stl.weld);
    return status;
}
