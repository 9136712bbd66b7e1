#include "support.h"

#include "proto/queries/point_sets.h"

DECODER(decode, struct proto_mean_request, proto_mean_request_decode)

#define POINTS "\"points\":[{\"vertex\":3},{\"vertex\":1}]"

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_mean_request mean;
    struct proto_problem problem;
    assert_true(decode("{" POINTS "}", &mean, &problem));
    assert_true(mean.points.count == 2 && !mean.weights.count &&
                mean.method == PROTO_METHOD_KARCHER);
    proto_mean_request_free(&mean);
    assert_true(decode("{" POINTS ",\"weights\":[0,2],\"method\":\"one_step\"}", &mean, &problem));
    assert_true(mean.weights.items[1] == 2 && mean.method == PROTO_METHOD_ONE_STEP);
    proto_mean_request_free(&mean);
    assert_true(decode("{" POINTS ",\"method\":\"karcher\"}", &mean, &problem));
    assert_int_equal(mean.method, PROTO_METHOD_KARCHER);
    proto_mean_request_free(&mean);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/points"},
        {"{\"points\":[]}", "/points"},
        {"{\"points\":[{\"vertex\":1},2]}", "/points/1"},
        {"{" POINTS ",\"weights\":[1]}", "/weights"},
        {"{" POINTS ",\"weights\":[]}", "/weights"},
        {"{" POINTS ",\"weights\":[1,\"2\"]}", "/weights/1"},
        {"{" POINTS ",\"weights\":[1,-2]}", "/weights"},
        {"{" POINTS ",\"weights\":[0,0]}", "/weights"},
        {"{" POINTS ",\"weights\":[1e308,1e308]}", "/weights"},
        {"{" POINTS ",\"method\":3}", "/method"},
        {"{" POINTS ",\"start\":3}", "/start"},
    };
    CHECK_REFUSED(decode, struct proto_mean_request, cases)
}

static void writes_answers(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_mean mean = {
        .residual = 0.25, .spread = 2, .iterations = 3, .converged = true, .is_cut = true};
    struct proto_options options = {.fields = UINT32_MAX, .names = proto_mean_fields};
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &mean.point, NULL), GD_OK);
    struct proto_writer writer = new_writer();
    proto_mean_encode(&writer, mesh, &mean, &options);
    assert_written(
        &writer,
        "{\"point\":{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0},"
        "\"residual\":0.25,\"spread\":2,\"iterations\":3,\"converged\":true,\"cut_locus\":true}");
    options.fields = PROTO_MEAN_FIELD_RESIDUAL;
    writer = new_writer();
    proto_mean_encode(&writer, mesh, &mean, &options);
    assert_written(&writer, "{\"residual\":0.25}");
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(decodes_bodies),
                                       cmocka_unit_test(refuses_bad_bodies),
                                       cmocka_unit_test(writes_answers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
