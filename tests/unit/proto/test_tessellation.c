#include "support.h"

#include "proto/queries/made_mesh.h"

static bool read(const char *text, struct proto_tessellation *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool ok = proto_tessellation_decode(document, 1000, out, problem);
    json_decref(document);
    return ok;
}

static void requests_are_read(void **state)
{
    struct proto_tessellation wanted;
    struct proto_problem problem;
    (void)state;
    assert_true(read("{\"mesh\":\"m\",\"tolerance\":0.25}", &wanted, &problem));
    assert_string_equal(wanted.mesh.text, "m");
    assert_true(wanted.options.deviation == 0.25 && wanted.options.faces == 1 &&
                wanted.options.steps[0] == 0);
    assert_true(read("{\"mesh\":\"m\",\"resolution\":[20,25]}", &wanted, &problem));
    assert_true(wanted.options.steps[0] == 20 && wanted.options.steps[1] == 25 &&
                wanted.options.deviation == 0);
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {{"{}", ""},
                 {"{\"mesh\":\"m\"}", ""},
                 {"{\"mesh\":\"m\",\"tolerance\":1,\"resolution\":[4,4]}", ""},
                 {"{\"tolerance\":1}", "/mesh"},
                 {"{\"mesh\":7,\"tolerance\":1}", "/mesh"},
                 {"{\"mesh\":\"../m\",\"tolerance\":1}", "/mesh"},
                 {"{\"mesh\":\"m\",\"tolerance\":-1}", "/tolerance"},
                 {"{\"mesh\":\"m\",\"resolution\":[4]}", "/resolution"},
                 {"{\"mesh\":\"m\",\"resolution\":[4,2]}", "/resolution"},
                 {"{\"mesh\":\"m\",\"resolution\":[4,4],\"up\":1}", "/up"}};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_tessellation wanted;
        struct proto_problem problem;
        assert_false(read(cases[i].body, &wanted, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

static void too_many_faces(void **state)
{
    struct proto_tessellation wanted;
    struct proto_problem problem;
    (void)state;
    assert_false(read("{\"mesh\":\"m\",\"resolution\":[20,26]}", &wanted, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, 1000);
    assert_string_equal(problem.pointer, "/resolution");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requests_are_read),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(too_many_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
