#include "support.h"

#include "proto/queries/voronoi.h"

DECODER(decode_whole, struct proto_voronoi_request, proto_voronoi_request_decode)

/* But for its set, which is let go again. */
static bool decode(const char *text, struct proto_voronoi_request *out,
                   struct proto_problem *problem)
{
    bool decoded = decode_whole(text, out, problem);
    if (decoded) proto_set_free(&out->set);
    return decoded;
}

#define SET "\"set\":{\"points\":[{\"vertex\":1},{\"vertex\":2}]}"

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_voronoi_request voronoi;
    struct proto_problem problem;
    assert_true(decode("{" SET "}", &voronoi, &problem));
    assert_true(voronoi.tolerance == 0);
    assert_true(decode("{" SET ",\"tolerance\":0.25}", &voronoi, &problem));
    assert_true(voronoi.tolerance == 0.25);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/set"},
        {"{\"set\":{\"points\":[]}}", "/set"},
        {"{" SET ",\"tolerance\":0}", "/tolerance"},
        {"{" SET ",\"tolerance\":-1}", "/tolerance"},
        {"{" SET ",\"tolerance\":\"1\"}", "/tolerance"},
        {"{" SET ",\"levels\":[1]}", "/levels"},
    };
    CHECK_REFUSED(decode, struct proto_voronoi_request, cases)
}

static void writes_answers(void **state)
{
    (void)state;
    const struct gd_bisector bisector = {.members = {2, 5}, .closed = true, .length = 0.5};
    struct proto_writer writer;
    proto_writer_init(&writer, 1 << 12);
    proto_voronoi_begin(&writer);
    proto_voronoi_labels_begin(&writer);
    proto_voronoi_label(&writer, 5);
    proto_voronoi_label(&writer, UINT32_MAX);
    proto_voronoi_list_end(&writer);
    proto_voronoi_bisectors_begin(&writer);
    proto_bisector_begin(&writer, &bisector);
    proto_bisector_end(&writer);
    proto_bisector_begin(&writer, &bisector);
    proto_bisector_points_begin(&writer);
    proto_voronoi_list_end(&writer);
    proto_bisector_end(&writer);
    proto_voronoi_list_end(&writer);
    proto_voronoi_end(&writer);
    assert_written(
        &writer,
        "{\"labels\":[5,null],\"bisectors\":[{\"members\":[2,5],\"closed\":true,\"length\":0.5},"
        "{\"members\":[2,5],\"closed\":true,\"length\":0.5,\"points\":[]}]}");
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
