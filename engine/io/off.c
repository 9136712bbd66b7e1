/* Object File Format of Geomview, text: keyword, counts, a line for each vertex and each face.
 * Numbers behind a vertex (the colours and normals of COFF, NOFF, STOFF ...) and behind a face (its
 * colour) are skipped. */
#include "io/readers.h"

#include <string.h>

/* The shortest lines: "0 0 0" and "3 0 1 2", each with its line end. */
#define SMALLEST_VERTEX 6
#define SMALLEST_FACE   8

enum keyword { NO_KEYWORD, KEYWORD_3D, KEYWORD_OTHER_DIMENSION };

/* [ST][C][N][4][n]OFF */
static enum keyword keyword_of(struct gd__word word)
{
    static const char *const prefixes[] = {"ST", "C", "N"};
    const char *at = word.at, *end = word.at + word.length;
    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++) {
        size_t length = strlen(prefixes[i]);
        if ((size_t)(end - at) >= length && memcmp(at, prefixes[i], length) == 0) at += length;
    }
    const char *dimension = at;
    if (at < end && *at == '4') at++;
    if (at < end && *at == 'n') at++;
    if (end - at != 3 || memcmp(at, "OFF", 3) != 0) return NO_KEYWORD;
    return at == dimension ? KEYWORD_3D : KEYWORD_OTHER_DIMENSION;
}

bool gd__off_recognise(struct gd__scan scan)
{
    scan.comments = true;
    gd__scan_skip_space(&scan);
    return keyword_of(gd__scan_word(&scan)) != NO_KEYWORD;
}

static enum gd_status read_keyword(struct gd__scan *scan)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    enum keyword keyword = keyword_of(gd__scan_word(scan));
    if (keyword == NO_KEYWORD) {
        scan->at = place;
        return gd__scan_unexpected(scan, "the keyword OFF");
    }
    if (keyword == KEYWORD_OTHER_DIMENSION) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED,
                             "OFF of other than three dimensions is not supported");
    }
    struct gd__scan ahead = *scan;
    if (gd__word_is(gd__scan_word(&ahead), "BINARY")) {
        return gd__scan_fail(scan, place, GD_UNSUPPORTED,
                             "binary OFF is not supported, only its text form");
    }
    return GD_OK;
}

/* Skips space first: the counts may stand on the keyword's line or a later one. */
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

/* Counts of vertices and faces; a third, of edges, is skipped with the line. */
static enum gd_status read_counts(struct gd__scan *scan, uint64_t *vertices, uint64_t *faces)
{
    enum gd_status status = read_count(scan, vertices);
    if (status == GD_OK) status = read_count(scan, faces);
    if (status != GD_OK) return status;
    const char *place = scan->at;
    gd__scan_skip_line(scan);
    /* The last line may lack its end. */
    size_t left = gd__scan_left(scan) + 1;
    if (*vertices > left / SMALLEST_VERTEX ||
        *faces > (left - *vertices * SMALLEST_VERTEX) / SMALLEST_FACE) {
        return gd__scan_fail(scan, place, GD_TRUNCATED,
                             "%llu vertices and %llu faces are declared, but only %zu bytes follow",
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

static enum gd_status read_face(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__scan_skip_space(scan);
    const char *place = scan->at;
    int64_t corners, vertex;
    enum gd_status status = gd__scan_integer(scan, &corners);
    for (int64_t corner = 0; status == GD_OK && corner < corners; corner++) {
        status = gd__scan_integer(scan, &vertex);
        if (status == GD_OK && vertex < 0)
            status = gd__builder_no_such_vertex(builder, vertex, place);
        if (status == GD_OK) status = gd__builder_add_corner(builder, (uint64_t)vertex, place);
    }
    if (status == GD_OK) status = gd__builder_close_polygon(builder, place);
    gd__scan_skip_line(scan);
    return status;
}

enum gd_status gd__off_read(struct gd__scan *scan, struct gd__builder *builder)
{
    scan->comments = true;
    uint64_t vertices = 0, faces = 0;
    enum gd_status status = read_keyword(scan);
    if (status == GD_OK) status = read_counts(scan, &vertices, &faces);
    if (status == GD_OK) status = gd__builder_reserve(builder, vertices, faces);
    for (uint64_t i = 0; status == GD_OK && i < vertices; i++) status = read_vertex(scan, builder);
    for (uint64_t i = 0; status == GD_OK && i < faces; i++) status = read_face(scan, builder);
    return status;
}
