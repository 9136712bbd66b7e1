#include "support.h"

#include <stdio.h>

#include "gd/point.h"
#include "proto/values/direction.h"

static bool decode(const char *text, struct proto_direction *out, struct proto_problem *problem)
{
    char array[256];
    snprintf(array, sizeof array, "[%s]", text);
    json_t *document = parse(array);
    bool decoded =
        proto_direction_decode(json_array_get(document, 0), "/directions/7", out, problem);
    json_decref(document);
    return decoded;
}

static void decodes_all_forms(void **state)
{
    (void)state;
    struct proto_direction direction;
    struct proto_problem problem;
    assert_true(decode("-2.5", &direction, &problem));
    assert_true(direction.has_angle && direction.angle == -2.5);
    assert_string_equal(direction.place, "/directions/7");
    assert_true(decode("{\"angle\":1}", &direction, &problem));
    assert_true(direction.has_angle && direction.angle == 1);
    assert_true(decode("{\"xyz\":[1,2,3],\"angle\":4}", &direction, &problem));
    assert_true(direction.has_angle && direction.angle == 4 && direction.xyz.z == 3);
    assert_true(decode("{\"xyz\":[1,2,3]}", &direction, &problem));
    assert_true(!direction.has_angle && direction.xyz.x == 1 && direction.xyz.y == 2 &&
                direction.xyz.z == 3);
    assert_true(decode("[1,2,3]", &direction, &problem));
    assert_true(!direction.has_angle && direction.xyz.x == 1 && direction.xyz.y == 2 &&
                direction.xyz.z == 3);
}

static void refuses_invalid_directions(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {{"\"x\"", "/directions/7"},
                 {"null", "/directions/7"},
                 {"{}", "/directions/7"},
                 {"[1,2]", "/directions/7"},
                 {"[1,2,\"3\"]", "/directions/7"},
                 {"[1,2,3,4]", "/directions/7"},
                 {"{\"angle\":[]}", "/directions/7/angle"},
                 {"{\"xyz\":[1]}", "/directions/7/xyz"},
                 {"{\"angles\":1}", "/directions/7/angles"}};
    struct proto_direction direction;
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_false(decode(cases[i].text, &direction, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

static void locates_and_encodes(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point corner;
    struct proto_direction direction;
    struct proto_problem problem;
    struct gd_direction out;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &corner, NULL), GD_OK);
    assert_true(decode("0", &direction, &problem));
    assert_true(proto_direction_locate(mesh, &corner, &direction, &out, &problem));
    struct proto_writer writer = new_writer();
    proto_direction_encode(&writer, &out);
    assert_written(&writer, "{\"angle\":0,\"xyz\":[1,0,0]}");
    assert_true(decode("[0,0,0]", &direction, &problem));
    assert_false(proto_direction_locate(mesh, &corner, &direction, &out, &problem));
    assert_pointer(&problem, "/directions/7");
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(decodes_all_forms),
                                       cmocka_unit_test(refuses_invalid_directions),
                                       cmocka_unit_test(locates_and_encodes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
