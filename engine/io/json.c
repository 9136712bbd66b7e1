/* JSON (RFC 8259): {"vertices": [[x, y, z], ...], "faces": [[i, j, k, ...], ...]}. The two members
 * may come in either order. Indices are zero-based.
 *
 * The nesting is fixed, so the parser needs no stack. An index may be written as 3.0, because JSON
 * does not distinguish integers from other numbers. */
#include "io/json_text.h"
#include "io/readers.h"

enum member { MEMBER_VERTICES, MEMBER_FACES, MEMBER_COUNT };

static const char *const member_names[MEMBER_COUNT] = {"vertices", "faces"};

/* Reads the beginning of an object or array. `*more` is true if it has an item. */
static enum gd_status open_items(struct gd__scan *scan, char open, char close, bool *more)
{
    enum gd_status status = gd__json_expect(scan, open);
    if (status == GD_OK) *more = !gd__json_accept(scan, close);
    return status;
}

/* Reads the separator after an item. `*more` is true if another item follows. */
static enum gd_status next_item(struct gd__scan *scan, char close, bool *more)
{
    *more = gd__json_accept(scan, ',');
    return *more ? GD_OK : gd__json_expect(scan, close);
}

static enum gd_status read_vertex(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__json_skip_space(scan);
    const char *place = scan->at;
    double xyz[3];
    enum gd_status status = gd__json_expect(scan, '[');
    for (int axis = 0; axis < 3 && status == GD_OK; axis++) {
        status = gd__json_number(scan, &xyz[axis]);
        if (status == GD_OK) status = gd__json_expect(scan, axis < 2 ? ',' : ']');
    }
    return status == GD_OK ? gd__builder_add_position(builder, xyz, place) : status;
}

static enum gd_status read_corner(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__json_skip_space(scan);
    const char *place = scan->at;
    double number;
    enum gd_status status = gd__json_number(scan, &number);
    return status == GD_OK ? gd__builder_add_index(builder, number, place) : status;
}

static enum gd_status read_face(struct gd__scan *scan, struct gd__builder *builder)
{
    gd__json_skip_space(scan);
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
                                enum gd_status (*read_item)(struct gd__scan *,
                                                            struct gd__builder *))
{
    bool more = false;
    enum gd_status status = open_items(scan, '[', ']', &more);
    while (status == GD_OK && more) {
        status = read_item(scan, builder);
        if (status == GD_OK) status = next_item(scan, ']', &more);
    }
    return status;
}

/* Returns in `out` the member with the name `key`. It is an error if `seen` says that this member
 * was already read. */
static enum gd_status member_of(const struct gd__scan *scan, struct gd__word key,
                                bool seen[MEMBER_COUNT], enum member *out)
{
    for (enum member member = 0; member < MEMBER_COUNT; member++) {
        if (!gd__json_string_is(key.at, member_names[member])) continue;
        if (seen[member])
            return gd__scan_fail(scan, key.at, GD_SYNTAX,
                                 "the key \"%s\" appears twice; remove one of the two",
                                 member_names[member]);
        seen[member] = true;
        *out = member;
        return GD_OK;
    }
    return gd__scan_fail(scan, key.at, GD_SYNTAX,
                         "unknown key %s: a mesh has \"vertices\" and \"faces\"",
                         gd__excerpt(key).text);
}

static enum gd_status read_member(struct gd__scan *scan, struct gd__builder *builder,
                                  bool seen[MEMBER_COUNT])
{
    struct gd__word key = {0};
    enum member member = MEMBER_VERTICES;
    gd__json_skip_space(scan);
    enum gd_status status = gd__json_string(scan, "a key", &key);
    if (status == GD_OK) status = member_of(scan, key, seen, &member);
    if (status == GD_OK) status = gd__json_expect(scan, ':');
    if (status != GD_OK) return status;
    return read_list(scan, builder, member == MEMBER_VERTICES ? read_vertex : read_face);
}

bool gd__json_recognise(struct gd__scan scan)
{
    return gd__json_accept(&scan, '{');
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
            return gd__scan_fail(scan, scan->at, GD_SYNTAX, "the key \"%s\" is missing",
                                 member_names[member]);
    }
    gd__json_skip_space(scan);
    return scan->at == scan->end ? GD_OK : gd__scan_unexpected(scan, "the end of the input");
}
