/* JSON (RFC 8259): {"vertices": [[x, y, z], ...], "faces": [[i, j, k, ...], ...]}, the two members in either order, zero-based indices.
 *
 * The depth is fixed, so there is no parser's stack. Keys are compared as they are written, without unescaping. A number is an index when
 * its value is whole: JSON knows no integers, 3.0 is 3. */
#include "io/readers.h"

#include <math.h>

enum member { MEMBER_VERTICES, MEMBER_FACES, MEMBER_COUNT };

static const char *const member_names[MEMBER_COUNT] = {"\"vertices\"", "\"faces\""};

static void skip_whitespace(struct gd__scan *scan)
{
    while (scan->at < scan->end && (*scan->at == ' ' || *scan->at == '\t' || gd__is_newline(*scan->at))) scan->at++;
}

/* Past whitespace and `c`, if that comes next. */
static bool accept(struct gd__scan *scan, char c)
{
    skip_whitespace(scan);
    if (scan->at == scan->end || *scan->at != c) return false;
    scan->at++;
    return true;
}

static enum gd_status expect(struct gd__scan *scan, char c)
{
    return accept(scan, c) ? GD_OK : gd__scan_unexpected(scan, (char[]){'\'', c, '\'', '\0'});
}

/* Begins an object or array; `*more` tells whether it has an item. */
static enum gd_status open_items(struct gd__scan *scan, char open, char close, bool *more)
{
    enum gd_status status = expect(scan, open);
    if (status == GD_OK) *more = !accept(scan, close);
    return status;
}

/* Behind an item; `*more` tells whether another one follows. */
static enum gd_status next_item(struct gd__scan *scan, char close, bool *more)
{
    *more = accept(scan, ',');
    return *more ? GD_OK : expect(scan, close);
}

static const char *skip_digits(const char *at, const char *end)
{
    while (at < end && *at >= '0' && *at <= '9') at++;
    return at;
}

/* The end of the number at `at` by JSON's grammar, which is narrower than other formats'; `at` itself if there is none. */
static const char *number_end(const char *at, const char *end)
{
    const char *integer = at < end && *at == '-' ? at + 1 : at;
    const char *next = skip_digits(integer, end);
    if (next == integer || (*integer == '0' && next - integer > 1)) return at;
    if (next < end && *next == '.') {
        const char *fraction = next + 1;
        next = skip_digits(fraction, end);
        if (next == fraction) return at;
    }
    if (next < end && (*next == 'e' || *next == 'E')) {
        const char *exponent = next + 1;
        if (exponent < end && (*exponent == '+' || *exponent == '-')) exponent++;
        next = skip_digits(exponent, end);
        if (next == exponent) return at;
    }
    return next;
}

static enum gd_status read_number(struct gd__scan *scan, double *out)
{
    skip_whitespace(scan);
    if (number_end(scan->at, scan->end) == scan->at) return gd__scan_unexpected(scan, "a JSON number");
    return gd__scan_number(scan, out);
}

static enum gd_status read_vertex(struct gd__scan *scan, struct gd__builder *builder)
{
    skip_whitespace(scan);
    const char *place = scan->at;
    double xyz[3];
    enum gd_status status = expect(scan, '[');
    for (int axis = 0; axis < 3 && status == GD_OK; axis++) {
        status = read_number(scan, &xyz[axis]);
        if (status == GD_OK) status = expect(scan, axis < 2 ? ',' : ']');
    }
    return status == GD_OK ? gd__builder_add_position(builder, xyz, place) : status;
}

static enum gd_status read_corner(struct gd__scan *scan, struct gd__builder *builder)
{
    skip_whitespace(scan);
    const char *place = scan->at;
    double number;
    enum gd_status status = read_number(scan, &number);
    return status == GD_OK ? gd__builder_add_index(builder, number, place) : status;
}

static enum gd_status read_face(struct gd__scan *scan, struct gd__builder *builder)
{
    skip_whitespace(scan);
    const char *place = scan->at;
    bool more = false;
    enum gd_status status = open_items(scan, '[', ']', &more);
    while (status == GD_OK && more) {
        status = read_corner(scan, builder);
        if (status == GD_OK) status = next_item(scan, ']', &more);
    }
    return status == GD_OK ? gd__builder_close_polygon(builder, place) : status;
}

static enum gd_status read_list(struct gd__scan *scan, struct gd__builder *builder,
                                enum gd_status (*read_item)(struct gd__scan *, struct gd__builder *))
{
    bool more = false;
    enum gd_status status = open_items(scan, '[', ']', &more);
    while (status == GD_OK && more) {
        status = read_item(scan, builder);
        if (status == GD_OK) status = next_item(scan, ']', &more);
    }
    return status;
}

/* Past a string; `*key` is what was written, quotes included. */
static enum gd_status read_key(struct gd__scan *scan, struct gd__word *key)
{
    key->at = scan->at;
    if (!accept(scan, '"')) return gd__scan_unexpected(scan, "a key");
    while (scan->at < scan->end && *scan->at != '"') {
        if ((unsigned char)*scan->at < ' ') return gd__scan_unexpected(scan, "the rest of a key");
        scan->at += *scan->at == '\\' && gd__scan_left(scan) > 1 ? 2 : 1;
    }
    key->length = (size_t)(scan->at - key->at) + 1;
    return expect(scan, '"');
}

/* The member that is called `key` and was not `seen` yet. */
static enum gd_status member_of(const struct gd__scan *scan, struct gd__word key, bool seen[MEMBER_COUNT],
                                enum member *out)
{
    for (enum member member = 0; member < MEMBER_COUNT; member++) {
        if (!gd__word_is(key, member_names[member])) continue;
        if (seen[member])
            return gd__scan_fail(scan, key.at, GD_SYNTAX, "the key %s is there twice", member_names[member]);
        seen[member] = true;
        *out = member;
        return GD_OK;
    }
    return gd__scan_fail(scan, key.at, GD_SYNTAX, "unknown key %s: a mesh has \"vertices\" and \"faces\"",
                         gd__excerpt(key).text);
}

static enum gd_status read_member(struct gd__scan *scan, struct gd__builder *builder, bool seen[MEMBER_COUNT])
{
    struct gd__word key = {0};
    enum member member = MEMBER_VERTICES;
    skip_whitespace(scan);
    enum gd_status status = read_key(scan, &key);
    if (status == GD_OK) status = member_of(scan, key, seen, &member);
    if (status == GD_OK) status = expect(scan, ':');
    if (status != GD_OK) return status;
    return read_list(scan, builder, member == MEMBER_VERTICES ? read_vertex : read_face);
}

bool gd__json_recognise(struct gd__scan scan)
{
    return accept(&scan, '{');
}

enum gd_status gd__json_read(struct gd__scan *scan, struct gd__builder *builder)
{
    scan->by_byte = true;
    bool seen[MEMBER_COUNT] = {false}, more = false;
    enum gd_status status = open_items(scan, '{', '}', &more);
    while (status == GD_OK && more) {
        status = read_member(scan, builder, seen);
        if (status == GD_OK) status = next_item(scan, '}', &more);
    }
    if (status != GD_OK) return status;
    for (enum member member = 0; member < MEMBER_COUNT; member++) {
        if (!seen[member])
            return gd__scan_fail(scan, scan->at, GD_SYNTAX, "the key %s is missing", member_names[member]);
    }
    skip_whitespace(scan);
    return scan->at == scan->end ? GD_OK : gd__scan_unexpected(scan, "the end of the input");
}
