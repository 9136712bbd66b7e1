#include "pixels.h"

#include "gd/picture.h"

enum { SIZE = 400 };

static struct gd_mesh *square(void)
{
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    return test_mesh(&(struct gd_polygons){positions, 4, 2, corners, NULL});
}

/* Returns the SVG file of layers on a square that is seen from the front. */
static char *drawn(const struct gd_picture_layer *layers, uint32_t count, bool has_legend)
{
    struct gd_mesh *mesh = square();
    void *bytes;
    size_t size;
    check_ok(gd_picture_svg(&(struct gd_picture){.mesh = mesh,
                                                 .width = SIZE,
                                                 .height = SIZE,
                                                 .view = GD_VIEW_FRONT,
                                                 .legend = has_legend,
                                                 .layers = layers,
                                                 .layer_count = count},
                            NULL, &bytes, &size),
             NULL);
    char *text = calloc(size + 1, 1);
    memcpy(text, bytes, size);
    free(bytes);
    gd_mesh_release(mesh);
    return text;
}

static uint32_t count_of(const char *text, const char *word)
{
    uint32_t count = 0;
    for (; (text = strstr(text, word)); text++) count++;
    return count;
}

/* The square has a margin of 12 pixels: position (x, y) is at 12 + 376 x, 388 - 376 y. */
static void lines_are_projected(void **state)
{
    (void)state;
    const struct gd_vec3 points[] = {{0, 0, 0}, {1, 1, 0}, {0.25, 0.5, 0}, {0.75, 0.5, 0}};
    char *text = drawn(&(struct gd_picture_layer){.points = points,
                                                  .first = (const uint32_t[]){0, 2, 4},
                                                  .count = 2,
                                                  .colour = GD_PICTURE_RGB(0x12ab9f),
                                                  .hidden = GD_HIDDEN_SHOWN,
                                                  .id = 7},
                       1, false);
    assert_non_null(strstr(text, "<g id=\"layer-7\">"));
    assert_non_null(strstr(text, "stroke=\"#12ab9f\""));
    assert_non_null(strstr(text, "M12 388L388 12M106 200L294 200\""));
    free(text);
}

/* A line below the surface is hidden; a line above the surface is visible. */
static void depth_hides_lines(void **state)
{
    (void)state;
    for (int side = -1; side <= 1; side += 2)
        for (unsigned hidden = GD_HIDDEN_FAINT; hidden <= GD_HIDDEN_SHOWN; hidden++) {
            const struct gd_vec3 points[] = {{0.2, 0.2, 0.5 * side}, {0.8, 0.8, 0.5 * side}};
            char *text = drawn(&(struct gd_picture_layer){.points = points,
                                                          .first = (const uint32_t[]){0, 2},
                                                          .count = 1,
                                                          .hidden = (enum gd_hidden)hidden},
                               1, false);
            bool is_dashed = side < 0 && hidden == GD_HIDDEN_FAINT,
                 is_drawn = side > 0 || hidden != GD_HIDDEN_NONE;
            assert_int_equal(strstr(text, "stroke-dasharray") != NULL, is_dashed);
            assert_int_equal(strstr(text, "<path") != NULL, is_drawn);
            free(text);
        }
}

static void arrows_have_heads(void **state)
{
    (void)state;
    const struct gd_vec3 points[] = {{0.5, 0.5, 0.1}, {0.9, 0.5, 0.1}};
    struct gd_picture_layer layer = {
        .points = points, .first = (const uint32_t[]){0, 2}, .count = 1, .width = 1};
    char *plain = drawn(&layer, 1, false);
    layer.ends = GD_LINE_ENDS_ARROWS;
    char *arrow = drawn(&layer, 1, false);
    assert_int_equal(count_of(plain, "M350.4 200"), 0);
    assert_int_equal(count_of(arrow, "M350.4 200L"), 2);
    free(plain);
    free(arrow);
}

/* The drawing omits the parts of lines that are far outside the picture. The view extends beyond
 * the square on three sides, by twice its size. */
static void far_lines_are_cut(void **state)
{
    (void)state;
    const struct gd_vec3 points[] = {{-1e5, 0.5, 0}, {1e5, 0.5, 0}, {-1e5, 1e5, 0}, {1e5, 1e5, 0}};
    char *text = drawn(&(struct gd_picture_layer){.points = points,
                                                  .first = (const uint32_t[]){0, 2, 4},
                                                  .count = 2,
                                                  .hidden = GD_HIDDEN_SHOWN},
                       1, false);
    assert_non_null(strstr(text, "M-400 275.2L800 275.2\""));
    free(text);
}

static void names_are_in_the_legend(void **state)
{
    (void)state;
    const struct gd_vec3 points[] = {{0.5, 0.5, 0}};
    const struct gd_picture_layer layers[] = {
        {.points = points, .count = 1, .name = "marks"},
        {.points = points, .count = 1, .labels = (const char *const[]){"a<b"}},
        {.points = points, .first = (const uint32_t[]){0, 1}, .count = 1, .name = "a point"}};
    char *text = drawn(layers, 3, true);
    assert_non_null(strstr(text, ">marks</text>"));
    assert_non_null(strstr(text, ">a&lt;b</text>"));
    assert_non_null(strstr(text, ">a point</text>"));
    free(text);
    text = drawn(layers, 3, false);
    assert_null(strstr(text, ">marks</text>"));
    free(text);
}

/* Each printable character but the space has strokes. */
static void every_letter_is_drawn(void **state)
{
    (void)state;
    const struct gd_vec3 points[] = {{0.5, 0.5, 0}};
    struct gd_mesh *mesh = square();
    for (char letter = '!'; letter <= '~'; letter++) {
        const char name[2] = {letter, '\0'};
        struct gd_picture picture = {
            .mesh = mesh,
            .width = 200,
            .height = 200,
            .view = GD_VIEW_FRONT,
            .layers = &(struct gd_picture_layer){.points = points, .count = 1, .name = name},
            .layer_count = 1,
            .legend = true};
        struct pixels pixels = draw(&picture);
        uint32_t dark = 0;
        for (uint32_t y = 170; y < 200; y++)
            for (uint32_t x = 38; x < 60; x++) dark += pixel_at(&pixels, x, y)[0] < 160;
        if (!dark) fail_msg("%c is not drawn", letter);
        free(pixels.byte);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_projected),     cmocka_unit_test(depth_hides_lines),
        cmocka_unit_test(arrows_have_heads),       cmocka_unit_test(far_lines_are_cut),
        cmocka_unit_test(names_are_in_the_legend), cmocka_unit_test(every_letter_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
