/* Pictures, of all formats. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/picture.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_mesh *mesh;
static struct gd_field *field;
static struct gd_path path;

static void open_pictures(void)
{
    struct gd_polygons polygons;
    struct gd_detail detail = {0};
    check_ok(sample_genus2(3, 0.2, &polygons), NULL);
    mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    struct gd_seed seed = {.point = test_vertex(mesh, 3)};
    struct gd_point to = test_vertex(mesh, 200);
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, &detail),
             &detail);
    check_ok(gd_field_path(field, &to, &path), NULL);
}

struct file {
    void *bytes;
    size_t size;
};

static void digest_file(struct digest *digest, const void *out)
{
    const struct file *file = out;
    digest_bytes(digest, file->bytes, file->size);
}

static void discard_file(void *out)
{
    free(((struct file *)out)->bytes);
}

static const struct answer a_file = {sizeof(struct file), digest_file, discard_file};

static struct gd_picture small(void)
{
    return (struct gd_picture){.mesh = mesh,
                               .field = field,
                               .path = &path,
                               .width = 240,
                               .height = 200,
                               .isolines = 4,
                               .legend = true};
}

static enum gd_status draw_png(void *out)
{
    struct file *file = out;
    struct gd_picture picture = small();
    return gd_picture_png(&picture, NULL, &file->bytes, &file->size);
}

static enum gd_status draw_svg(void *out)
{
    struct file *file = out;
    struct gd_picture picture = small();
    return gd_picture_svg(&picture, NULL, &file->bytes, &file->size);
}

static const struct gd_vec3 places[] = {{0, 0, 0}, {1, 1, 0.3}, {0.5, 2, 0}, {9, 9, 9}};
static const uint32_t first[] = {0, 2, 4};
static const char *const labels[] = {"A", NULL, "C", "D"};
static const struct gd_picture_layer layers[] = {
    {.points = places, .first = first, .count = 2, .name = "lines", .ends = GD_LINE_ENDS_ARROWS},
    {.points = places,
     .first = first,
     .count = 2,
     .hidden = GD_HIDDEN_SHOWN,
     .ends = GD_LINE_ENDS_MARKS},
    {.points = places, .count = 4, .labels = labels, .name = "marks"}};

static enum gd_status draw_layers(void *out)
{
    struct file *file = out;
    struct gd_picture picture = small();
    picture.path = NULL;
    picture.layers = layers;
    picture.layer_count = COUNT(layers);
    picture.zoom = 2;
    picture.target = &places[1];
    return gd_picture_svg(&picture, NULL, &file->bytes, &file->size);
}

static enum gd_status draw_scene(void *out)
{
    struct file *file = out;
    struct gd_picture picture = small();
    picture.layers = layers;
    picture.layer_count = COUNT(layers);
    return gd_picture_glb(&picture, NULL, &file->bytes, &file->size);
}

static enum gd_status draw_bare(void *out)
{
    struct file *file = out;
    return gd_picture_png(
        &(struct gd_picture){.mesh = mesh, .width = 60, .height = 40, .view = GD_VIEW_TOP}, NULL,
        &file->bytes, &file->size);
}

static const struct operation items[] = {
    {"picture as PNG", &a_file, draw_png, GD_OK, NULL},
    {"picture as SVG", &a_file, draw_svg, GD_OK, NULL},
    {"picture with layers", &a_file, draw_layers, GD_OK, NULL},
    {"picture as GLB", &a_file, draw_scene, GD_OK, NULL},
    {"picture of a mesh alone", &a_file, draw_bare, GD_OK, NULL},
};

const struct operations picture_operations = {open_pictures, items, COUNT(items)};
