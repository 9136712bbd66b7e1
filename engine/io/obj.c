/* Wavefront OBJ: reads "v x y z" and "f a b c ..." with one-based or relative indices. Skips all
 * other statements, and opens no file that a statement names. A face may come before its
 * vertices. */
#include "io/readers.h"

#include <string.h>

static void set_dialect(struct gd__scan *scan)
{
    scan->comments = true;
    scan->continued = true;
}

static bool is_keyword(struct gd__word word)
{
    static const char *const keywords[] = {"v", "vt", "vn", "vp", "f",      "l",
                                           "p", "o",  "g",  "s",  "mtllib", "usemtl"};
    for (size_t i = 0; i < sizeof keywords / sizeof keywords[0]; i++) {
        if (gd__word_is(word, keywords[i])) return true;
    }
    return false;
}

/* Recognises the format by its first word. If that word is unknown, searches for a vertex on a
 * later line, because all readers skip lines that they do not know. */
bool gd__obj_recognise(struct gd__scan scan)
{
    double xyz[3];
    scan.detail = NULL;
    set_dialect(&scan);
    gd__scan_skip_space(&scan);
    struct gd__word word = gd__scan_word(&scan);
    bool is_obj = is_keyword(word);
    for (; !is_obj && gd__scan_left(&scan) > 0; word = gd__scan_word(&scan)) {
        is_obj = gd__word_is(word, "v") && gd__scan_xyz(&scan, xyz) == GD_OK;
        gd__scan_skip_line(&scan);
    }
    return is_obj;
}

/* Reads a vertex. Whatever follows its coordinates (a weight, a colour) is skipped with the
 * line. */
static enum gd_status read_vertex(struct gd__scan *scan, struct gd__builder *builder)
{
    const char *place = scan->at;
    double xyz[3];
    enum gd_status status = gd__scan_xyz(scan, xyz);
    return status == GD_OK ? gd__builder_add_position(builder, xyz, place) : status;
}

/* Skips "/7", "//7" or "/7/7" after the vertex of a corner. */
static enum gd_status skip_attributes(struct gd__scan *scan)
{
    if (scan->at < scan->end && *scan->at == '/') {
        while (scan->at < scan->end && strchr("/-0123456789", *scan->at) && *scan->at) scan->at++;
    }
    bool ended = gd__scan_at_line_end(scan) || gd__is_blank(*scan->at) || *scan->at == '\\';
    return ended ? GD_OK : gd__scan_unexpected(scan, "the next corner");
}

static enum gd_status read_corner(struct gd__scan *scan, struct gd__builder *builder)
{
    const char *place = scan->at;
    int64_t number;
    enum gd_status status = gd__scan_integer(scan, &number);
    if (status == GD_OK) status = skip_attributes(scan);
    if (status != GD_OK) return status;
    int64_t vertex = number > 0 ? number - 1 : (int64_t)builder->position_count + number;
    if (number == 0 || vertex < 0) return gd__builder_no_such_vertex(builder, number, place);
    return gd__builder_add_corner(builder, (uint64_t)vertex, place);
}

static enum gd_status read_face(struct gd__scan *scan, struct gd__builder *builder)
{
    const char *place = scan->at;
    enum gd_status status = GD_OK;
    gd__scan_skip_blanks(scan);
    while (status == GD_OK && !gd__scan_at_line_end(scan)) {
        status = read_corner(scan, builder);
        gd__scan_skip_blanks(scan);
    }
    return status == GD_OK ? gd__builder_close_polygon(builder, place) : status;
}

enum gd_status gd__obj_read(struct gd__scan *scan, struct gd__builder *builder)
{
    set_dialect(scan);
    builder->index_base = 1;
    enum gd_status status = GD_OK;
    for (; status == GD_OK && scan->at < scan->end; gd__scan_skip_line(scan)) {
        struct gd__word keyword = gd__scan_word(scan);
        if (gd__word_is(keyword, "v"))
            status = read_vertex(scan, builder);
        else if (gd__word_is(keyword, "f"))
            status = read_face(scan, builder);
        else
            status = gd__builder_look(builder);
    }
    return status;
}
