#include "support.h"

DECODER(decode_whole, struct proto_voronoi_request, proto_voronoi_request_decode)

/* Decodes a request and releases its set, so that the tests need not release it. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(refuses_bad_bodies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
