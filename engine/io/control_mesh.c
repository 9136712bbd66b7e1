/* Control meshes: reads any mesh file, and in OBJ the tag lines `t name ints/floats/strings
 * values...` of OpenSubdiv. */
#include "gd/control_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "io/readers.h"
#include "io/utf16.h"

void gd_control_mesh_free(struct gd_control_mesh *mesh)
{
    if (!mesh) return;
    gd_polygons_free(&mesh->polygons);
    free(mesh->creases);
    free(mesh->corners);
    *mesh = (struct gd_control_mesh){0};
}

/* The number of integers, floats and strings of a tag, from the text "ints/floats/strings" after
 * the tag's name. */
struct counts {
    int64_t whole, real, text;
};

/* A tag whose values are being read: first its integers, then its floats. */
struct tag {
    struct gd__scan *scan;
    struct gd_control_mesh *mesh;
    const char *place;
    struct counts counts;
};

static enum gd_status read_counts(struct gd__scan *scan, struct counts *out)
{
    int64_t *counts[] = {&out->whole, &out->real, &out->text};
    enum gd_status status = GD_OK;
    for (int i = 0; !status && i < 3; i++) {
        status = gd__scan_integer(scan, counts[i]);
        if (!status && (*counts[i] < 0 || *counts[i] > 1 << 30))
            status = gd__scan_unexpected(scan, "a count");
        if (status || i == 2) break;
        if (gd__scan_left(scan) == 0 || *scan->at != '/')
            return gd__scan_unexpected(scan, "counts such as 2/1/0");
        scan->at++;
    }
    return status;
}

static enum gd_status read_vertex(const struct tag *tag, uint32_t *out)
{
    int64_t vertex;
    const char *place = tag->scan->at;
    enum gd_status status = gd__scan_integer(tag->scan, &vertex);
    if (status) return status;
    if (vertex < 0 || vertex >= tag->mesh->polygons.position_count)
        return gd__scan_fail(
            tag->scan, place, GD_INDEX,
            "the tag refers to vertex %lld, but the vertices are numbered from 0 to %u",
            (long long)vertex, tag->mesh->polygons.position_count - 1);
    *out = (uint32_t)vertex;
    return GD_OK;
}

/* Reads the sharpness of item `index`. A tag has one sharpness for all items, or one for each. */
static enum gd_status read_sharpness(const struct tag *tag, int64_t index, double *value)
{
    return index < tag->counts.real ? gd__scan_number(tag->scan, value) : GD_OK;
}

/* Checks the counts of a tag, and that it has no more values than its line has characters. */
static enum gd_status check_counts(const struct tag *tag, int64_t least, int64_t items)
{
    const struct counts *counts = &tag->counts;
    if (counts->whole < least || (counts->real != 1 && counts->real != items) || counts->text != 0)
        return gd__scan_fail(tag->scan, tag->place, GD_SYNTAX,
                             "the tag has %lld integers and %lld real numbers; give one sharpness "
                             "for all items, or one for each item",
                             (long long)counts->whole, (long long)counts->real);
    if ((uint64_t)counts->whole <= gd__scan_left(tag->scan)) return GD_OK;
    return gd__scan_fail(tag->scan, tag->place, GD_TRUNCATED,
                         "the tag declares %lld integers, but its line ends before them",
                         (long long)counts->whole);
}

static void *grown(void *array, uint32_t count, int64_t more, size_t size)
{
    return realloc(array, (count + (size_t)more + 1) * size);
}

static enum gd_status read_crease(const struct tag *tag)
{
    struct gd_control_mesh *mesh = tag->mesh;
    int64_t edges = tag->counts.whole - 1;
    enum gd_status status = check_counts(tag, 2, edges);
    if (status) return status;
    struct gd_crease *creases = grown(mesh->creases, mesh->crease_count, edges, sizeof *creases);
    if (!creases) return GD_NO_MEMORY;
    mesh->creases = creases;
    creases += mesh->crease_count;
    uint32_t vertex = 0, before;
    status = read_vertex(tag, &vertex);
    for (int64_t i = 0; !status && i < edges; i++) {
        before = vertex;
        status = read_vertex(tag, &vertex);
        creases[i] = (struct gd_crease){{before, vertex}, 0};
    }
    double sharpness = 0;
    for (int64_t i = 0; !status && i < edges; i++) {
        status = read_sharpness(tag, i, &sharpness);
        creases[i].sharpness = sharpness;
    }
    if (!status) mesh->crease_count += (uint32_t)edges;
    return status;
}

static enum gd_status read_corner(const struct tag *tag)
{
    struct gd_control_mesh *mesh = tag->mesh;
    int64_t count = tag->counts.whole;
    enum gd_status status = check_counts(tag, 1, count);
    if (status) return status;
    struct gd_corner *corners = grown(mesh->corners, mesh->corner_count, count, sizeof *corners);
    if (!corners) return GD_NO_MEMORY;
    mesh->corners = corners;
    corners += mesh->corner_count;
    for (int64_t i = 0; !status && i < count; i++) status = read_vertex(tag, &corners[i].vertex);
    double sharpness = 0;
    for (int64_t i = 0; !status && i < count; i++) {
        status = read_sharpness(tag, i, &sharpness);
        corners[i].sharpness = sharpness;
    }
    if (!status) mesh->corner_count += (uint32_t)count;
    return status;
}

static enum gd_status read_boundary(const struct tag *tag)
{
    static const enum gd_interpolate_boundary rules[] = {
        GD_INTERPOLATE_NONE, GD_INTERPOLATE_EDGE_AND_CORNER, GD_INTERPOLATE_EDGE_ONLY};
    int64_t number;
    enum gd_status status = gd__scan_integer(tag->scan, &number);
    if (status) return status;
    if (number < 0 || number > 2)
        return gd__scan_fail(tag->scan, tag->place, GD_SYNTAX,
                             "interpolateboundary must be 0, 1 or 2, but is %lld",
                             (long long)number);
    tag->mesh->boundary = rules[number];
    return GD_OK;
}

static enum gd_status read_tag(struct gd__scan *scan, struct gd_control_mesh *mesh)
{
    struct tag tag = {.scan = scan, .mesh = mesh, .place = scan->at};
    struct gd__word name = gd__scan_word(scan);
    if (name.length > 10 && memcmp(name.at, "facevarying", 11) == 0) return GD_OK;
    enum gd_status status = read_counts(scan, &tag.counts);
    if (status) return status;
    if (gd__word_is(name, "crease")) return read_crease(&tag);
    if (gd__word_is(name, "corner")) return read_corner(&tag);
    if (gd__word_is(name, "interpolateboundary")) return read_boundary(&tag);
    return gd__scan_fail(scan, tag.place, GD_UNSUPPORTED,
                         "the tag '%s' is not supported; remove it", gd__excerpt(name).text);
}

static enum gd_status read_tags(const void *bytes, size_t size,
                                const struct gd_read_options *limits, struct gd_control_mesh *mesh,
                                struct gd_detail *detail)
{
    struct gd__scan scan = gd__scan_begin(bytes, size, detail);
    scan.comments = scan.continued = true;
    scan.deadline_ns = limits && limits->control ? limits->control->deadline_ns : 0;
    enum gd_status status = GD_OK;
    for (uint32_t line = 0; !status && scan.at < scan.end; gd__scan_skip_line(&scan), line++) {
        if (line % 4096 == 0) status = gd_control_check(limits ? limits->control : NULL, 1);
        if (!status && gd__word_is(gd__scan_word(&scan), "t")) status = read_tag(&scan, mesh);
    }
    return gd__scan_end(&scan, status);
}

enum gd_status gd_read_control_mesh(const void *bytes, size_t size,
                                    const struct gd_read_options *options,
                                    struct gd_control_mesh *out, struct gd_detail *detail)
{
    struct gd_read_options own = options ? *options : (struct gd_read_options){0};
    if (own.format == GD_FORMAT_ANY) own.format = gd_format_recognise(bytes, size);
    struct gd_control_mesh mesh = {0};
    enum gd_status status = GD_OK;
    char *text = NULL;
    if (gd__is_utf16_text(bytes, size, own.format))
        status = gd__utf16_decode(bytes, size, own.control, &text, &size);
    if (text) bytes = text;
    if (!status) status = gd_read_polygons(bytes, size, &own, &mesh.polygons, detail);
    if (!status && own.format == GD_FORMAT_OBJ)
        status = read_tags(bytes, size, &own, &mesh, detail);
    free(text);
    if (status)
        gd_control_mesh_free(&mesh);
    else
        *out = mesh;
    return status;
}
