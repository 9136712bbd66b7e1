/* Object File Format of Geomview, as text: a keyword, counts, a line for each vertex, one or more
 * lines for each face. Numbers after a vertex (the colours and normals of COFF, NOFF, STOFF ...)
 * and after a face (its colour) are skipped. */
#include "io/readers.h"

#include <string.h>

/* The shortest lines: "0 0 0", "0" and "3 0 1 2", each with its line end. A face with fewer than
 * three corners is skipped, so no memory is reserved for it. */
#define SMALLEST_VERTEX   6
#define SMALLEST_FACE     2
#define SMALLEST_TRIANGLE 8

/* Returns the length of the keyword "[ST][C][N][4][n]OFF" at the beginning of the word. The number
 * of vertices may follow without a blank. Returns 0 if there is no such keyword. */
static size_t keyword_length(struct gd__word word, bool *is_3d)
{
    static const char *const prefixes[] = {"ST", "C", "N", "4", "n"};
    const char *at = word.at, *end = word.at + word.length;
    *is_3d = true;
    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++) {
        size_t length = strlen(prefixes[i]);
        if ((size_t)(end - at) < length || memcmp(at, prefixes[i], length) != 0) continue;
        at += length;
        if (i >= 3) *is_3d = false;
    }
    if (end - at < 3 || memcmp(at, "OFF", 3) != 0) return 0;
    at += 3;
    return at == end || (*at >= '0' && *at <= '9') ? (size_t)(at - word.at) : 0;
}

bool gd__off_recognise(struct gd__scan scan)
{
    bool is_3d;
    scan.comments = true;
    gd__scan_skip_space(&scan);
    return keyword_length(gd__scan_word(&scan), &is_3d) > 0;
}

static enum gd_status read_keyword(struct gd__scan *scan)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    bool is_3d;
    size_t length = keyword_length(gd__scan_word(scan), &is_3d);
    scan->at = place + length;
    if (length == 0) return gd__scan_unexpected(scan, "the keyword OFF");
    if (!is_3d) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED,
                             "OFF of other than three dimensions is not supported");
    }
    struct gd__scan ahead = *scan;
    if (gd__word_is(gd__scan_word(&ahead), "BINARY")) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED,
                             "binary OFF is not supported; send the text form");
    }
    return GD_OK;
}

/* Reads a count. Skips space and line ends first, because the counts may be on the keyword's line
 * or on a later line. */
static enum gd_status read_count(struct gd__scan *scan, uint64_t *out)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    int64_t count;
    enum gd_status status = gd__scan_integer(scan, &count);
    if (status != GD_OK) return status;
    if (count < 0) return gd__scan_fail(scan, place, GD_SYNTAX, "a count is negative");
    *out = (uint64_t)count;
    return GD_OK;
}

/* Skips the number of edges, which is on the rest of the line, alone on the next line, or missing.
 * A line of a vertex has at least three numbers. */
static void skip_edges(struct gd__scan *scan)
{
    int64_t edges;
    gd__scan_skip_blanks(scan);
    bool is_next = gd__scan_at_line_end(scan);
    gd__scan_skip_line(scan);
    struct gd__scan ahead = *scan;
    ahead.detail = NULL; /* a missing number is no error */
    gd__scan_skip_space(&ahead);
    if (!is_next || gd__scan_integer(&ahead, &edges) != GD_OK) return;
    gd__scan_skip_blanks(&ahead);
    if (!gd__scan_at_line_end(&ahead)) return;
    scan->at = ahead.at;
    gd__scan_skip_line(scan);
}

/* Reads the numbers of vertices and faces, and skips that of edges. */
static enum gd_status read_counts(struct gd__scan *scan, uint64_t *vertices, uint64_t *faces)
{
    enum gd_status status = read_count(scan, vertices);
    if (status == GD_OK) status = read_count(scan, faces);
    if (status != GD_OK) return status;
    const char *place = scan->at;
    skip_edges(scan);
    /* The last line may have no line end. */
    size_t left = gd__scan_left(scan) + 1;
    if (*vertices > left / SMALLEST_VERTEX ||
        *faces > (left - *vertices * SMALLEST_VERTEX) / SMALLEST_FACE) {
        return gd__scan_fail(scan, place, GD_TRUNCATED,
                             "%llu vertices and %llu faces are declared, but only %zu bytes "
                             "follow; send the whole file",
                             (unsigned long long)*vertices, (unsigned long long)*faces, left - 1);
    }
    return GD_OK;
}

static enum gd_status read_vertex(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    double xyz[3];
    enum gd_status status = gd__scan_xyz(scan, xyz);
    gd__scan_skip_line(scan);
    return status == GD_OK ? gd__builder_add_position(builder, xyz, place) : status;
}

/* Reads a corner. Sets `*is_wrapped` to true if it is on a later line than the previous corner. */
static enum gd_status read_corner(struct gd__scan *scan, bool *is_wrapped, int64_t *out)
{
    gd__scan_skip_blanks(scan);
    if (gd__scan_at_line_end(scan)) *is_wrapped = true;
    gd__scan_skip_space(scan);
    return gd__scan_integer(scan, out);
}

/* Ends a face. If all corners are on one line, skips the rest of the line, which may be a colour.
 * If the corners take several lines, the line must end after the last corner, because more text
 * there could be the beginning of another face. */
static enum gd_status end_face(struct gd__scan *scan, bool is_wrapped)
{
    gd__scan_skip_blanks(scan);
    if (is_wrapped && !gd__scan_at_line_end(scan))
        return gd__scan_unexpected(scan, "the end of a face that began on another line");
    gd__scan_skip_line(scan);
    return GD_OK;
}

static enum gd_status read_face(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    int64_t corners, vertex;
    bool is_wrapped = false;
    enum gd_status status = gd__scan_integer(scan, &corners);
    for (int64_t corner = 0; status == GD_OK && corner < corners; corner++) {
        status = read_corner(scan, &is_wrapped, &vertex);
        if (status == GD_OK && vertex < 0)
            status = gd__builder_no_such_vertex(builder, vertex, place);
        if (status == GD_OK) status = gd__builder_add_corner(builder, (uint64_t)vertex, place);
    }
    if (status == GD_OK) status = gd__builder_close_polygon(builder, place);
    return status == GD_OK ? end_face(scan, is_wrapped) : status;
}

enum gd_status gd__off_read(struct gd__scan *scan, struct gd__builder *builder)
{
    scan->comments = true;
    uint64_t vertices = 0, faces = 0;
    enum gd_status status = read_keyword(scan);
    if (status == GD_OK) status = read_counts(scan, &vertices, &faces);
    uint64_t most = gd__scan_left(scan) / SMALLEST_TRIANGLE + 1;
    if (status == GD_OK)
        status = gd__builder_reserve(builder, vertices, faces < most ? faces : most);
    for (uint64_t i = 0; status == GD_OK && i < vertices; i++) status = read_vertex(scan, builder);
    for (uint64_t i = 0; status == GD_OK && i < faces; i++) status = read_face(scan, builder);
    return status;
}
