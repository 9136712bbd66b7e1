#include "support.h"

#include <math.h>

#include "proto/queries/point_sets.h"

DECODER(decode, struct proto_sampling_request, proto_sampling_request_decode)

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_sampling_request sampling;
    struct proto_problem problem;
    assert_true(decode("{\"count\":3}", &sampling, &problem));
    assert_true(sampling.count == 3 && !sampling.has_start);
    assert_true(decode("{\"count\":10000,\"start\":{\"vertex\":7}}", &sampling, &problem));
    assert_true(sampling.count == 10000 && sampling.has_start && sampling.start.vertex == 7);
    assert_string_equal(sampling.start.place, "/start");
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/count"},
        {"{\"count\":0}", "/count"},
        {"{\"count\":-1}", "/count"},
        {"{\"count\":2.5}", "/count"},
        {"{\"count\":2,\"start\":4}", "/start"},
        {"{\"count\":2,\"start\":null}", "/start"},
        {"{\"count\":2,\"from\":{\"vertex\":1}}", "/from"},
    };
    struct proto_sampling_request sampling;
    struct proto_problem problem;
    CHECK_REFUSED(decode, struct proto_sampling_request, cases)
    assert_false(decode("{\"count\":10001}", &sampling, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
}

static void writes_answers(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point points[2];
    for (uint32_t i = 0; i < 2; i++)
        assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){i}, &points[i], NULL), GD_OK);
    const double radii[2] = {INFINITY, 0.5};
    struct proto_options options = {
        .fields = UINT32_MAX, .names = proto_sampling_fields, .geometry = PROTO_GEOMETRY_XYZ};
    struct proto_writer writer;
    proto_writer_init(&writer, 1 << 12);
    proto_sampling_encode(&writer, mesh, points, radii, 2, NAN, &options);
    assert_written(&writer, "{\"points\":[[0,0,0],[1,0,0]],\"radii\":[null,0.5]}");
    options.geometry = PROTO_GEOMETRY_NONE;
    proto_writer_init(&writer, 1 << 12);
    proto_sampling_encode(&writer, mesh, points, radii, 2, NAN, &options);
    assert_written(&writer, "{\"radii\":[null,0.5]}");
    options = (struct proto_options){.fields = PROTO_SAMPLING_FIELD_POINTS,
                                     .names = proto_sampling_fields};
    proto_writer_init(&writer, 1 << 12);
    proto_sampling_encode(&writer, mesh, points, radii, 1, 0.25, &options);
    assert_written(&writer,
                   "{\"points\":[{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0,"
                   "\"snap_distance\":0.25}]}");
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(writes_answers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
