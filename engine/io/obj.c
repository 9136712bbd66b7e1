/* Wavefront OBJ: reads "v x y z" and "f a b c ..." with one-based or relative indices. Skips all
 * other statements, and opens no file that a statement names. A face may come before its
 * vertices. */
#include "io/readers.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
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

/* Reads a vertex. Text after its coordinates (a weight, a colour) is skipped with the line. */
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
    if (number < 0 && builder->is_part) return GD_INDEX; /* read_parts stops before this part */
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

/* Reads statements up to the end of the scan. */
static enum gd_status read_statements(struct gd__scan *scan, struct gd__builder *builder)
{
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

/* --- several threads -------------------------------------------------------------------------- */

#define PART_BYTES ((size_t)4 << 20)

/* A part of the text that consists of whole statements. */
struct part {
    struct parts *all;
    uint32_t index;
    struct gd__scan scan;
    struct gd__builder builder;
    struct gd_control control;
};

struct parts {
    struct gd__builder *builder; /* builder of the whole text */
    pthread_t caller;
    enum gd_status status; /* status of the caller's control */
    /* Number of parts that can be appended: all before the first part that could not be read. Later
       parts are not read. */
    atomic_uint good;
    uint32_t count;
    struct part list[];
};

static void part_fail(const struct part *part)
{
    unsigned good = atomic_load(&part->all->good);
    while (part->index < good &&
           !atomic_compare_exchange_weak(&part->all->good, &good, part->index))
        continue;
}

/* Receives the progress of a part. On the caller's thread, checks the caller's control. */
static bool part_go_on(void *user, double fraction)
{
    const struct part *part = user;
    struct parts *all = part->all;
    struct gd__builder *builder = all->builder;
    (void)fraction;
    if (pthread_equal(pthread_self(), all->caller)) {
        const struct gd__scan *whole = builder->scan;
        double done = (double)(part->scan.at - whole->begin) / (double)(whole->end - whole->begin);
        if (done > builder->done) builder->done = done;
        all->status = gd_control_check(builder->limits.control, builder->done);
        if (all->status) atomic_store(&all->good, 0);
    }
    return part->index < atomic_load(&all->good);
}

static void part_read(void *context, uint32_t index)
{
    struct parts *all = context;
    struct part *part = &all->list[index];
    struct gd_read_options limits = all->builder->limits;
    limits.control = &part->control;
    limits.skipped = NULL;
    part->builder = gd__builder_begin(&part->scan, &limits);
    part->builder.is_part = index > 0;
    if (index >= atomic_load(&all->good)) return;
    if (read_statements(&part->scan, &part->builder)) part_fail(part);
}

/* Returns the end of the first statement that ends at or after `at`: the position after the next
 * line end that no backslash precedes. */
static const char *statement_end(const char *at, const char *end)
{
    while ((at = memchr(at, '\n', (size_t)(end - at)))) {
        at++;
        const char *last = at[-2] == '\r' ? at - 3 : at - 2;
        if (*last != '\\') return at;
    }
    return end;
}

static struct parts *parts_create(const struct gd__scan *scan, struct gd__builder *builder)
{
    uint32_t count = (uint32_t)(gd__scan_left(scan) / PART_BYTES);
    struct parts *parts = calloc(1, sizeof *parts + count * sizeof parts->list[0]);
    const char *at = scan->at;
    if (!parts) return NULL;
    parts->builder = builder;
    parts->caller = pthread_self();
    parts->count = count;
    atomic_init(&parts->good, count);
    for (uint32_t i = 0; i < count; i++) {
        struct part *part = &parts->list[i];
        const char *least = i + 1 < count ? scan->at + (i + 1) * PART_BYTES : scan->end;
        *part = (struct part){.all = parts, .index = i, .scan = *scan};
        part->control = (struct gd_control){
            .deadline_ns = scan->deadline_ns, .progress = part_go_on, .user = part};
        part->scan.detail = NULL;
        part->scan.begin = part->scan.at = at;
        if (least > at) at = statement_end(least, scan->end);
        part->scan.end = at;
    }
    return parts;
}

/* Reserves the memory for all parts that were read, unless their polygons exceed the limits. */
static enum gd_status parts_reserve(const struct parts *parts, uint32_t good)
{
    struct gd__builder *builder = parts->builder;
    uint64_t positions = 0, triangles = 0;
    for (uint32_t i = 0; i < good; i++) {
        positions += parts->list[i].builder.position_count;
        triangles += parts->list[i].builder.triangles;
    }
    if (positions > builder->limits.max_vertices || triangles > builder->limits.max_faces)
        return GD_OK;
    return gd__builder_reserve(builder, positions, triangles);
}

/* Appends the parts that were read, and advances the scan past them. */
static void parts_append(struct parts *parts, struct gd__scan *scan, uint32_t good)
{
    for (uint32_t i = 0; i < parts->count; i++) {
        struct part *part = &parts->list[i];
        if (i < good && gd__builder_append(parts->builder, &part->builder))
            scan->at = part->scan.end;
        else
            good = 0;
        gd__builder_free(&part->builder);
    }
}

/* Reads the beginning of a long text on the threads of the executor, in parts. Stops before the
 * first part that has an error or a relative vertex number; the caller reads the rest. So errors
 * and vertex numbers are the same as without threads. */
static enum gd_status read_parts(struct gd__scan *scan, struct gd__builder *builder)
{
    const struct gd_control *control = builder->limits.control;
    const struct gd_executor *executor = control ? control->executor : NULL;
    if (!executor || executor->width < 2 || gd__scan_left(scan) < 2 * PART_BYTES) return GD_OK;
    struct parts *parts = parts_create(scan, builder);
    if (!parts) return GD_OK;
    gd_executor_run(executor, part_read, parts, parts->count);
    uint32_t good = atomic_load(&parts->good);
    enum gd_status status = parts->status ? parts->status : parts_reserve(parts, good);
    parts_append(parts, scan, status ? 0 : good);
    free(parts);
    return status;
}

enum gd_status gd__obj_read(struct gd__scan *scan, struct gd__builder *builder)
{
    set_dialect(scan);
    builder->index_base = 1;
    enum gd_status status = read_parts(scan, builder);
    return status ? status : read_statements(scan, builder);
}
