#include "pixels.h"

#include <math.h>

#include "gd/control.h"
#include "render/colour.h"
#include "tests/samples/samples.h"
#include "tests/support/two_threads.h"
#include "tests/support/watch.h"

/* --- areas ------------------------------------------------------------------------------------ */

/* Returns the sum of the opacities, which is the covered area in pixels. */
static double opaque_area(const struct pixels *pixels)
{
    double area = 0;
    assert_int_equal(pixels->channels, 4);
    for (size_t i = 0; i < (size_t)pixels->width * pixels->height; i++)
        area += pixels->byte[4 * i + 3] / 255.0;
    return area;
}

/* The opaque area equals the triangle's area on the screen. */
static void a_triangle_has_its_area(void **state)
{
    (void)state;
    struct rng rng = {3};
    double worst = 0;
    for (int round = 0; round < 20; round += TEST_STRIDE) {
        double positions[3][3] = {
            {0, 0, 0}, {1, rng_between(&rng, 0.2, 0.8), 0}, {rng_between(&rng, 0.2, 0.8), 1, 0}};
        uint32_t corners[3] = {0, 1, 2};
        struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){positions, 3, 1, corners, NULL});
        struct pixels pixels = draw(&(struct gd_picture){.mesh = mesh,
                                                         .width = 400,
                                                         .height = 400,
                                                         .view = GD_VIEW_FRONT,
                                                         .background = GD_BACKGROUND_TRANSPARENT});
        double side = 400 - 2 * 16 * fmax(sqrt(400 * 400 / 480000.0), 0.75);
        double exact = 0.5 *
                       (positions[1][0] * positions[2][1] - positions[1][1] * positions[2][0]) *
                       side * side;
        worst = fmax(worst, check_close(opaque_area(&pixels), exact, 1e-3));
        free(pixels.byte);
        gd_mesh_release(mesh);
    }
    print_message("# areas of triangles: off by %.1e at most\n", worst);
}

/* An inclined border has pixels of all sixteenths of opacity. */
static void borders_are_smooth(void **state)
{
    (void)state;
    double positions[3][3] = {{0, 0, 0}, {1, 0.07, 0}, {0.06, 1, 0}};
    uint32_t corners[3] = {0, 1, 2}, levels = 0;
    bool has[17] = {false};
    struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){positions, 3, 1, corners, NULL});
    struct pixels pixels = draw(&(struct gd_picture){.mesh = mesh,
                                                     .width = 400,
                                                     .height = 400,
                                                     .view = GD_VIEW_FRONT,
                                                     .background = GD_BACKGROUND_TRANSPARENT});
    for (size_t i = 0; i < 400 * 400; i++) has[(pixels.byte[4 * i + 3] * 16 + 127) / 255] = true;
    for (int i = 0; i <= 16; i++) levels += has[i];
    assert_int_equal(levels, 17);
    free(pixels.byte);
    gd_mesh_release(mesh);
}

/* --- distances -------------------------------------------------------------------------------- */

enum { FLAT_WIDTH = 640, FLAT_HEIGHT = 480, CELLS = 4 };

struct flat {
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    struct gd_field *field;
    double scale, left, bottom; /* pixels per unit; position of (0, 0) in pixels */
};

/* Opens a rectangle of few large triangles and the field of a point in it. */
static struct flat open_flat(double x, double y)
{
    struct flat flat;
    double unit = fmax(sqrt(FLAT_WIDTH * FLAT_HEIGHT / 480000.0), 0.75), margin = 16 * unit;
    check_ok(sample_grid(CELLS, CELLS, 4, 3, &flat.polygons), NULL);
    flat.mesh = test_mesh(&flat.polygons);
    struct gd_seed seed = {.point = test_point_near(flat.mesh, x, y, 0)};
    struct gd_detail detail = {0};
    check_ok(gd_field_build(flat.mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                            NULL, &flat.field, &detail),
             &detail);
    flat.scale = fmin((FLAT_WIDTH - 2 * margin) / 4, (FLAT_HEIGHT - 2 * margin) / 3);
    flat.left = FLAT_WIDTH / 2.0 - 2 * flat.scale;
    flat.bottom = FLAT_HEIGHT / 2.0 + 1.5 * flat.scale;
    return flat;
}

static void close_flat(struct flat *flat)
{
    gd_field_release(flat->field);
    gd_mesh_release(flat->mesh);
    gd_polygons_free(&flat->polygons);
}

/* In a plane the shading is uniform. Pixels show the colour of the exact distance, however far the
 * nearest vertex is. */
static void colours_are_those_of_the_distance(void **state)
{
    (void)state;
    double x = 1.37, y = 1.11, range = hypot(4 - x, 3 - y), shade = -1, worst = 0;
    struct flat flat = open_flat(x, y);
    struct pixels pixels = draw(&(struct gd_picture){.mesh = flat.mesh,
                                                     .field = flat.field,
                                                     .width = FLAT_WIDTH,
                                                     .height = FLAT_HEIGHT,
                                                     .view = GD_VIEW_FRONT});
    for (uint32_t row = 40; row < FLAT_HEIGHT - 40; row++)
        for (uint32_t column = 60; column < FLAT_WIDTH - 60; column++) {
            double px = (column + 0.5 - flat.left) / flat.scale,
                   py = (flat.bottom - row - 0.5) / flat.scale, distance = hypot(px - x, py - y);
            struct gd__colour colour = gd__colour_of_part(distance / range);
            const uint8_t *pixel = pixel_at(&pixels, column, row);
            /* the mark of the source covers these pixels */
            if (distance * flat.scale < 8) continue;
            if (shade < 0) shade = pixel[1] / (255 * colour.green);
            worst = fmax(worst, fabs(pixel[0] - 255 * shade * colour.red));
            worst = fmax(worst, fabs(pixel[1] - 255 * shade * colour.green));
            worst = fmax(worst, fabs(pixel[2] - 255 * shade * colour.blue));
        }
    print_message("# colours of distances: off by %.2f of 255 at most\n", worst);
    assert_true(worst < 3);
    free(pixels.byte);
    close_flat(&flat);
}

/* The isolines are circles at multiples of 0.5. Only the pixels near these circles are darker than
 * in a picture without isolines. */
static void isolines_are_circles(void **state)
{
    (void)state;
    double x = 1.9, y = 1.4, step = 0.5;
    struct flat flat = open_flat(x, y);
    struct gd_picture picture = {.mesh = flat.mesh,
                                 .field = flat.field,
                                 .width = FLAT_WIDTH,
                                 .height = FLAT_HEIGHT,
                                 .view = GD_VIEW_FRONT};
    struct pixels without = draw(&picture);
    picture.isolines = 5;
    struct pixels with = draw(&picture);
    for (uint32_t row = 0; row < FLAT_HEIGHT; row++)
        for (uint32_t column = 0; column < FLAT_WIDTH; column++) {
            double px = (column + 0.5 - flat.left) / flat.scale,
                   py = (flat.bottom - row - 0.5) / flat.scale, distance = hypot(px - x, py - y),
                   off = fabs(distance - step * round(distance / step)) * flat.scale;
            bool is_inside =
                px > 0.05 && px < 3.95 && py > 0.05 && py < 2.95 && distance * flat.scale > 8;
            int darker = pixel_at(&without, column, row)[1] - pixel_at(&with, column, row)[1];
            if (!is_inside) continue;
            if (darker > 2) assert_true(off < 1.3);
            if (off < 0.3) assert_true(darker > 10);
        }
    free(with.byte);
    free(without.byte);
    close_flat(&flat);
}

/* --- paths ------------------------------------------------------------------------------------ */

static bool is_red(const uint8_t *pixel)
{
    return pixel[0] > 150 && pixel[1] < 50 && pixel[2] < 60;
}

static void a_path_is_drawn_in_place(void **state)
{
    (void)state;
    double x = 0.4, y = 0.6, to_x = 3.7, to_y = 2.2;
    struct flat flat = open_flat(x, y);
    struct gd_point to = test_point_near(flat.mesh, to_x, to_y, 0);
    struct gd_path path;
    check_ok(gd_field_path(flat.field, &to, &path), NULL);
    struct pixels pixels = draw(&(struct gd_picture){.mesh = flat.mesh,
                                                     .path = &path,
                                                     .width = FLAT_WIDTH,
                                                     .height = FLAT_HEIGHT,
                                                     .view = GD_VIEW_FRONT});
    uint32_t red = 0;
    double length = path.length * flat.scale,
           unit = fmax(sqrt(FLAT_WIDTH * FLAT_HEIGHT / 480000.0), 0.75);
    for (uint32_t row = 0; row < FLAT_HEIGHT; row++)
        for (uint32_t column = 0; column < FLAT_WIDTH; column++) {
            double px = (column + 0.5 - flat.left) / flat.scale - x,
                   py = (flat.bottom - row - 0.5) / flat.scale - y, dx = to_x - x, dy = to_y - y,
                   along = (px * dx + py * dy) / hypot(dx, dy),
                   across = fabs(px * dy - py * dx) / hypot(dx, dy) * flat.scale;
            bool is_between = along * flat.scale > 8 && along * flat.scale < length - 8,
                 has_red = is_red(pixel_at(&pixels, column, row));
            if (is_between && across < 1.5 * unit - 0.75) assert_true(has_red);
            if (has_red && is_between) assert_true(across < 1.5 * unit + 0.75);
            red += has_red && is_between;
        }
    assert_true(red > length - 16); /* the line is drawn in its full length */
    free(pixels.byte);
    gd_path_free(&path);
    close_flat(&flat);
}

/* Draws the same path on a sphere. The path is solid seen from the front, and faint and dashed seen
 * from behind. */
static void hidden_lines_are_faint(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    uint32_t red[2] = {0};
    check_ok(sample_icosphere(4, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point_near(mesh, -0.5, 0.1, 1)};
    struct gd_point to = test_point_near(mesh, 0.5, -0.2, 1);
    struct gd_field *field;
    struct gd_path path;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    check_ok(gd_field_path(field, &to, &path), NULL);
    for (int behind = 0; behind < 2; behind++) {
        struct pixels pixels =
            draw(&(struct gd_picture){.mesh = mesh,
                                      .path = &path,
                                      .width = 300,
                                      .height = 300,
                                      .view = behind ? GD_VIEW_BACK : GD_VIEW_FRONT});
        for (uint32_t i = 0; i < 300 * 300; i++)
            red[behind] += is_red(pixels.byte + (size_t)i * pixels.channels);
        free(pixels.byte);
    }
    assert_true(red[0] > 200);
    assert_int_equal(red[1], 0);
    gd_path_free(&path);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- requests of any kind --------------------------------------------------------------------- */

static enum gd_status status_of(const struct gd_picture *picture, const struct gd_control *control)
{
    void *bytes = NULL;
    size_t size = 0;
    enum gd_status status = gd_picture_png(picture, control, &bytes, &size);
    assert_true(status ? bytes == NULL : bytes != NULL);
    free(bytes);
    return status;
}

static void invalid_pictures_are_refused(void **state)
{
    (void)state;
    static const struct gd_vec3 far[] = {{NAN, 0, 0}, {0, 1e9, 0}}, near[2] = {{0, 0, 0}};
    struct flat flat = open_flat(1, 1), other = open_flat(2, 2);
    const struct gd_picture wrong[] = {
        {.width = 15},
        {.width = 4097},
        {.width = 4096, .height = 4096},
        {.isolines = GD_PICTURE_ISOLINES + 1},
        {.view = GD_VIEW_DIRECTION},
        {.view = GD_VIEW_DIRECTION, .direction = {NAN, 0, 0}},
        {.up = {0, INFINITY, 0}},
        {.field = other.field},
        {.zoom = 0.5},
        {.zoom = 1 + GD_PICTURE_ZOOM},
        {.target = &far[1]},
        {.levels = (const double[]){-1}, .level_count = 1},
        {.isoline_width = GD_PICTURE_WIDTH + 1},
        {.layer_count = GD_PICTURE_LAYERS + 1},
        {.layers = &(struct gd_picture_layer){.points = far, .count = 1}, .layer_count = 1},
        {.layers = &(struct gd_picture_layer){.points = far + 1, .count = 1}, .layer_count = 1},
        {.layers = &(struct gd_picture_layer){.width = -1}, .layer_count = 1},
        {.layers = &(struct gd_picture_layer){.name = "\n"}, .layer_count = 1},
        {.layers = &(struct gd_picture_layer){.points = near,
                                              .count = 1,
                                              .labels = (const char *const[]){"\x7f"}},
         .layer_count = 1},
        {.layers = &(struct gd_picture_layer){.points = near,
                                              .count = 2,
                                              .first = (const uint32_t[]){2, 1, 2}},
         .layer_count = 1},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct gd_picture picture = wrong[i];
        picture.mesh = flat.mesh;
        assert_int_equal(status_of(&picture, NULL), GD_INVALID_ARGUMENT);
    }
    close_flat(&flat);
    close_flat(&other);
}

static void random_pictures(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct rng rng = {21};
    check_ok(sample_genus2(6, 0.3, &polygons), NULL);
    for (int k = 0; k < 3; k++) /* the surface is far from the origin, or tiny */
        for (uint32_t i = 0; i < polygons.position_count; i++)
            polygons.positions[i][k] = polygons.positions[i][k] * 1e-3 + 1e3;
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_vertex(mesh, 7)};
    struct gd_field *field;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    for (int round = 0; round < 60; round += TEST_IS_SANITIZED ? 7 : 1) {
        struct gd_point to = test_point(mesh, test_random_place(&polygons, &rng));
        struct gd_path path;
        check_ok(gd_field_path(field, &to, &path), NULL);
        struct gd_picture picture = {
            .mesh = mesh,
            .field = round % 3 ? field : NULL,
            .path = round % 2 ? &path : NULL,
            .width = 16 + rng_below(&rng, 400),
            .height = 16 + rng_below(&rng, 300),
            .view = round % 9,
            .direction = {rng_between(&rng, -1e-200, 1e-200), rng_between(&rng, -1e200, 1e200), 0},
            .up = {rng_between(&rng, -1, 1), round % 4, rng_between(&rng, -1e-9, 1e-9)},
            .isolines = rng_below(&rng, 20),
            .edges = round % 5 == 0,
            .legend = round % 2,
            .background = round % 3};
        struct pixels pixels = draw(&picture);
        assert_int_equal(pixels.width, picture.width);
        assert_int_equal(pixels.height, picture.height);
        free(pixels.byte);
        gd_path_free(&path);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void an_svg_has_lines_and_an_image(void **state)
{
    (void)state;
    struct flat flat = open_flat(1, 1);
    struct gd_point to = test_point_near(flat.mesh, 3, 2, 0);
    struct gd_path path;
    void *bytes;
    size_t size;
    check_ok(gd_field_path(flat.field, &to, &path), NULL);
    check_ok(gd_picture_svg(&(struct gd_picture){.mesh = flat.mesh,
                                                 .field = flat.field,
                                                 .path = &path,
                                                 .isolines = 8,
                                                 .legend = true},
                            NULL, &bytes, &size),
             NULL);
    char *text = calloc(size + 1, 1);
    memcpy(text, bytes, size);
    assert_non_null(strstr(text, "<image"));
    assert_non_null(strstr(text, ">distance</text>"));
    assert_non_null(strstr(text, ">path length 2.2360679"));
    assert_string_equal(text + size - 7, "</svg>\n");
    free(text);
    free(bytes);
    gd_path_free(&path);
    close_flat(&flat);
}

/* --- control ---------------------------------------------------------------------------------- */

static void the_control_is_checked(void **state)
{
    (void)state;
    struct flat flat = open_flat(1, 1);
    struct test_watch watch = {0};
    const struct gd_picture picture = {.mesh = flat.mesh, .field = flat.field, .isolines = 10};
    assert_int_equal(
        status_of(&picture, &(struct gd_control){.progress = test_watch, .user = &watch}), GD_OK);
    assert_true(watch.calls > 50 && watch.last > 0.9);
    for (uint32_t most = 1; most < watch.calls; most += 1 + watch.calls * TEST_STRIDE / 20) {
        struct test_watch again = {.most = most};
        assert_int_equal(
            status_of(&picture, &(struct gd_control){.progress = test_watch, .user = &again}),
            GD_CANCELLED);
    }
    assert_int_equal(status_of(&picture, &(struct gd_control){.deadline_ns = 1}), GD_DEADLINE);
    assert_int_equal(status_of(&picture, &(struct gd_control){.budget_bytes = 1 << 20}), GD_BUDGET);
    assert_int_equal(status_of(&picture, &(struct gd_control){.budget_bytes = 64 << 20}), GD_OK);
    close_flat(&flat);
}

/* No direction shows most of the points, so all directions are tried. The points lie on one side
 * for some rounds; then the search ends early. */
static void two_threads_choose_the_same_view(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){3, 1}, &polygons);
    const struct gd_control both = {.executor = &two_threads};
    struct rng rng = {5};
    for (int round = 0; round < 12; round++) {
        struct gd_vec3 points[9];
        for (int i = 0; i < 9; i++) {
            const double *p = polygons.positions[rng_below(&rng, polygons.position_count)];
            points[i] = (struct gd_vec3){p[0], round % 2 ? -fabs(p[1]) : p[1], p[2]};
        }
        const struct gd_picture_layer layer = {.points = points, .count = 9};
        const struct gd_picture picture = {.mesh = mesh, .layers = &layer, .layer_count = 1};
        void *one, *two;
        size_t size, same;
        check_ok(gd_picture_png(&picture, NULL, &one, &size), NULL);
        check_ok(gd_picture_png(&picture, &both, &two, &same), NULL);
        assert_int_equal(size, same);
        assert_memory_equal(one, two, size);
        free(one);
        free(two);
    }
    gd_polygons_free(&polygons);
    gd_mesh_release(mesh);
}

/* The surface has a boundary, several bands of rows, and more faces than a slice. An odd number of
 * isolines leaves one of them alone. */
static void pictures_do_not_depend_on_the_threads(void **state)
{
    (void)state;
    enum gd_status (*const draw[])(const struct gd_picture *, const struct gd_control *, void **,
                                   size_t *) = {gd_picture_png, gd_picture_svg, gd_picture_glb};
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){80, 1}, NULL);
    const struct gd_seed seed = {.point = {.kind = GD_POINT_VERTEX, .element = 40}};
    struct gd_field *field;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    const struct gd_picture picture = {.mesh = mesh, .field = field, .isolines = 15, .edges = true};
    const struct gd_control both = {.executor = &two_threads};
    for (int i = 0; i < 3; i++) {
        void *one, *two;
        size_t size, same;
        check_ok(draw[i](&picture, NULL, &one, &size), NULL);
        check_ok(draw[i](&picture, &both, &two, &same), NULL);
        assert_int_equal(size, same);
        assert_memory_equal(one, two, size);
        free(one);
        free(two);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Returns the least budget that suffices for a picture without an executor, and up to 4096 more. */
static size_t least_budget(const struct gd_picture *picture)
{
    size_t low = 0, high = 16 << 20;
    while (high - low > 4096) {
        size_t middle = (low + high) / 2;
        enum gd_status status =
            status_of(picture, &(struct gd_control){.budget_bytes = middle ? middle : 1});
        assert_true(status == GD_OK || status == GD_BUDGET);
        *(status ? &low : &high) = middle;
    }
    return high;
}

/* Where the budget is too small for two lanes, one lane begins unfinished bands again. */
static void threads_need_no_larger_budget(void **state)
{
    (void)state;
    struct flat flat = open_flat(1, 1);
    const struct gd_picture picture = {
        .mesh = flat.mesh, .field = flat.field, .width = 200, .height = 200, .view = GD_VIEW_FRONT};
    void *one, *two;
    size_t size, same, least = least_budget(&picture);
    check_ok(gd_picture_png(&picture, NULL, &one, &size), NULL);
    for (size_t more = 0; more < 64; more++) {
        const struct gd_control both = {.executor = &two_threads,
                                        .budget_bytes = least + (more << 16)};
        check_ok(gd_picture_png(&picture, &both, &two, &same), NULL);
        assert_int_equal(size, same);
        assert_memory_equal(one, two, size);
        free(two);
    }
    free(one);
    close_flat(&flat);
}

static void two_threads_can_be_cancelled(void **state)
{
    (void)state;
    struct flat flat = open_flat(1, 1);
    const struct gd_picture picture = {
        .mesh = flat.mesh, .field = flat.field, .width = 200, .height = 200, .isolines = 5};
    for (uint32_t most = 1; most < 20; most++) {
        struct test_watch watch = {.most = most};
        const struct gd_control both = {
            .executor = &two_threads, .progress = test_watch, .user = &watch};
        assert_int_equal(status_of(&picture, &both), GD_CANCELLED);
    }
    close_flat(&flat);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_triangle_has_its_area),
                                       cmocka_unit_test(borders_are_smooth),
                                       cmocka_unit_test(colours_are_those_of_the_distance),
                                       cmocka_unit_test(isolines_are_circles),
                                       cmocka_unit_test(a_path_is_drawn_in_place),
                                       cmocka_unit_test(hidden_lines_are_faint),
                                       cmocka_unit_test(invalid_pictures_are_refused),
                                       cmocka_unit_test(random_pictures),
                                       cmocka_unit_test(an_svg_has_lines_and_an_image),
                                       cmocka_unit_test(the_control_is_checked),
                                       cmocka_unit_test(two_threads_choose_the_same_view),
                                       cmocka_unit_test(pictures_do_not_depend_on_the_threads),
                                       cmocka_unit_test(threads_need_no_larger_budget),
                                       cmocka_unit_test(two_threads_can_be_cancelled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
