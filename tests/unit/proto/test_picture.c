#include "support.h"

#include "proto/queries/picture.h"

static struct proto_picture parsed(struct proto_parameters parameters)
{
    struct proto_picture picture;
    struct proto_problem problem = {0};
    if (!proto_picture_parse(&parameters, &picture, &problem)) fail_msg("%s", problem.detail);
    return picture;
}

static void defaults_draw_the_mesh_only(void **state)
{
    (void)state;
    struct proto_parameters none = NO_QUERY;
    struct proto_picture picture = parsed(none);
    assert_null(picture.field);
    assert_false(picture.has_source);
    assert_int_equal(picture.stops.count, 0);
    assert_int_equal(picture.picture.width, 800);
    assert_int_equal(picture.picture.height, 600);
    assert_int_equal(picture.picture.view, GD_VIEW_CHOSEN);
    assert_int_equal(picture.picture.isolines, 0);
    assert_true(picture.picture.legend && !picture.picture.edges);
    assert_true(picture.picture.up.y == 1);
}

static void reads_all_options(void **state)
{
    (void)state;
    struct proto_picture picture =
        parsed(QUERY("source", "v:4", "from", "v:1", "via", "v:2;v:3", "to", "e:3-9:0.25", "view",
                     "-1,2.5e3,0", "up", "z", "size", "16x4096", "isolines", "0", "edges", "true",
                     "legend", "false", "background", "dark"));
    assert_true(picture.has_source);
    assert_int_equal(picture.stops.count, 4);
    assert_int_equal(picture.picture.view, GD_VIEW_DIRECTION);
    assert_true(picture.picture.direction.x == -1 && picture.picture.direction.y == 2500);
    assert_true(picture.picture.up.z == 1 && picture.picture.up.y == 0);
    assert_int_equal(picture.picture.width, 16);
    assert_int_equal(picture.picture.height, 4096);
    assert_int_equal(picture.picture.isolines, 0);
    assert_true(picture.picture.edges && !picture.picture.legend);
    assert_int_equal(picture.picture.background, GD_BACKGROUND_DARK);
    proto_picture_free(&picture);
    proto_picture_free(&picture);
    picture = parsed(QUERY("field", "0123", "view", "left"));
    assert_string_equal(picture.field, "0123");
    assert_int_equal(picture.picture.isolines, 10);
    assert_int_equal(picture.picture.view, GD_VIEW_LEFT);
}

static void errors_name_the_parameter(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"size", ""},           {"size", "800"},      {"size", "800x"},     {"size", "x600"},
        {"size", "800X600"},    {"size", "800x600x"}, {"size", "800x 600"}, {"size", "15x600"},
        {"size", "4097x600"},   {"size", "0x0"},      {"size", "08x600"},   {"view", ""},
        {"view", "Front"},      {"view", "1,2"},      {"view", "1,2,3,"},   {"view", "1,2,x"},
        {"view", "0,-0,0"},     {"up", ""},           {"up", "x"},          {"up", "0,0,0"},
        {"isolines", "-1"},     {"isolines", "101"},  {"edges", "1"},       {"legend", "True"},
        {"background", "none"}, {"source", ""},       {"source", "4"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_picture picture = {.field = "untouched"};
        struct proto_problem problem;
        struct proto_parameters parameters = QUERY(cases[i][0], cases[i][1]);
        assert_false(proto_picture_parse(&parameters, &picture, &problem));
        assert_parameter(&problem, cases[i][0]);
        assert_string_equal(picture.field, "untouched");
    }
}

static void a_path_has_two_ends_and_a_picture_one_field(void **state)
{
    (void)state;
    struct proto_picture picture;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("from", "v:1");
    assert_false(proto_picture_parse(&parameters, &picture, &problem));
    assert_parameter(&problem, "to");
    parameters = QUERY("via", "v:1", "to", "v:2");
    assert_false(proto_picture_parse(&parameters, &picture, &problem));
    assert_parameter(&problem, "from");
    parameters = QUERY("field", "0", "source", "v:2");
    assert_false(proto_picture_parse(&parameters, &picture, &problem));
    assert_parameter(&problem, "source");
    parameters = QUERY("size", "4096x4096");
    assert_false(proto_picture_parse(&parameters, &picture, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_draw_the_mesh_only),
        cmocka_unit_test(reads_all_options),
        cmocka_unit_test(errors_name_the_parameter),
        cmocka_unit_test(a_path_has_two_ends_and_a_picture_one_field),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
