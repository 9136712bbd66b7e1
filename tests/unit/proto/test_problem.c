#include "support.h"

static void encodes_applicable_members(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_writer writer = new_writer();
    assert_false(
        proto_problem_set(&problem, PROTO_PROBLEM_NOT_FOUND, "there is no mesh \"%s\"", "cow"));
    proto_problem_encode(&writer, &problem);
    assert_written(
        &writer,
        "{\"type\":\"urn:geodesicd:problem:not_found\",\"title\":\"Not found\",\"status\":404,"
        "\"detail\":\"there is no mesh \\\"cow\\\"\",\"code\":\"not_found\"}");

    writer = new_writer();
    assert_false(proto_problem_refuse(&problem, "", "the body is empty"));
    proto_problem_limit(&problem, 32);
    proto_problem_encode(&writer, &problem);
    assert_written(&writer, "{\"type\":\"urn:geodesicd:problem:invalid_request\",\"title\":"
                            "\"Invalid request\",\"status\":400,"
                            "\"detail\":\"the body is "
                            "empty\",\"code\":\"invalid_request\",\"pointer\":\"\",\"limit\":32}");

    writer = new_writer();
    assert_false(proto_problem_refuse(&problem, "from", "no point"));
    proto_problem_encode(&writer, &problem);
    assert_written(&writer,
                   "{\"type\":\"urn:geodesicd:problem:invalid_request\",\"title\":\"Invalid "
                   "request\",\"status\":400,"
                   "\"detail\":\"no point\",\"code\":\"invalid_request\",\"parameter\":\"from\"}");
}

static void encodes_elements(void **state)
{
    (void)state;
    struct gd_detail detail = {0};
    struct proto_problem problem;
    struct proto_writer writer = new_writer();
    gd_detail_add(&detail, GD_ELEMENT_EDGE, 3, 9);
    gd_detail_add(&detail, GD_ELEMENT_EDGE, 4, 5);
    assert_false(proto_problem_from_status(&problem, GD_NON_MANIFOLD_EDGE, &detail));
    proto_problem_encode(&writer, &problem);
    assert_written(
        &writer,
        "{\"type\":\"urn:geodesicd:problem:invalid_mesh\",\"title\":\"Invalid "
        "mesh\",\"status\":422,"
        "\"detail\":\"an edge belongs to more than two faces\",\"code\":\"invalid_mesh\","
        "\"reason\":\"non_manifold_edge\",\"elements\":[{\"edge\":[3,9]},{\"edge\":[4,5]}]}");

    writer = new_writer();
    detail = (struct gd_detail){.text = "line 7: expected a number"};
    gd_detail_add(&detail, GD_ELEMENT_LINE, 7, 0);
    assert_false(proto_problem_from_status(&problem, GD_SYNTAX, &detail));
    proto_problem_encode(&writer, &problem);
    assert_written(
        &writer,
        "{\"type\":\"urn:geodesicd:problem:invalid_mesh\",\"title\":\"Invalid "
        "mesh\",\"status\":422,"
        "\"detail\":\"line 7: expected a number\",\"code\":\"invalid_mesh\",\"reason\":\"syntax\","
        "\"elements\":[{\"line\":7}]}");
}

static void maps_every_status(void **state)
{
    (void)state;
    static const struct {
        enum gd_status status;
        enum proto_problem_code code;
        unsigned http;
    } cases[] = {
        {GD_INVALID_ARGUMENT, PROTO_PROBLEM_INVALID_REQUEST, 400},
        {GD_OUT_OF_RANGE, PROTO_PROBLEM_INVALID_REQUEST, 400},
        {GD_UNREFERENCED_VERTEX, PROTO_PROBLEM_INVALID_REQUEST, 400},
        {GD_NO_SUCH_EDGE, PROTO_PROBLEM_INVALID_REQUEST, 400},
        {GD_NOT_ON_SURFACE, PROTO_PROBLEM_POINT_NOT_ON_SURFACE, 422},
        {GD_BEYOND_REACH, PROTO_PROBLEM_INTERNAL, 500},
        {GD_NO_MEMORY, PROTO_PROBLEM_INSUFFICIENT_MEMORY, 507},
        {GD_BUDGET, PROTO_PROBLEM_INSUFFICIENT_MEMORY, 507},
        {GD_TOO_LARGE, PROTO_PROBLEM_TOO_LARGE, 413},
        {GD_CANCELLED, PROTO_PROBLEM_DRAINING, 503},
        {GD_DEADLINE, PROTO_PROBLEM_DEADLINE_EXCEEDED, 504},
        {GD_INTERNAL, PROTO_PROBLEM_INTERNAL, 500},
    };
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_false(proto_problem_from_status(&problem, cases[i].status, NULL));
        assert_int_equal(problem.code, cases[i].code);
        assert_int_equal(problem.status, cases[i].http);
        assert_null(problem.reason);
        if (cases[i].status == GD_DEADLINE) assert_non_null(strstr(problem.detail, "timeout_ms"));
    }
    for (int status = GD_UNRECOGNIZED; status <= GD_NOT_TRIANGULABLE; status++) {
        assert_false(proto_problem_from_status(&problem, (enum gd_status)status, NULL));
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_MESH);
        assert_string_equal(problem.reason, gd_status_name((enum gd_status)status));
        assert_string_equal(problem.detail, gd_status_sentence((enum gd_status)status));
    }
}

static void hides_details_of_a_failed_self_check(void **state)
{
    (void)state;
    struct gd_detail detail = {.text = "path 0.30 but distance 0.31"};
    struct proto_problem problem;
    assert_false(proto_problem_from_status(&problem, GD_INTERNAL, &detail));
    assert_null(strstr(problem.detail, "0.3"));
}

static void encodes_retry_after(void **state)
{
    (void)state;
    struct proto_problem problem;
    assert_false(proto_problem_from_status(&problem, GD_CANCELLED, NULL));
    assert_true(problem.retry_after > 0);
}

static void escapes_pointers(void **state)
{
    (void)state;
    struct proto_problem problem;
    proto_problem_refuse(&problem, "/a", "…");
    assert_false(proto_problem_descend(&problem, "m~n/o"));
    assert_pointer(&problem, "/a/m~0n~1o");
    proto_problem_refuse(&problem, "", "…");
    proto_problem_descend(&problem, "");
    assert_pointer(&problem, "/");
    proto_problem_refuse(&problem, "to", "…");
    proto_problem_descend(&problem, "vertex");
    assert_parameter(&problem, "to");
}

static void shortens_long_texts(void **state)
{
    (void)state;
    char slashes[2000];
    memset(slashes, '/', sizeof slashes - 1);
    slashes[sizeof slashes - 1] = '\0';
    struct proto_problem problem;
    proto_problem_refuse(&problem, slashes, "%s", slashes);
    assert_int_equal(strlen(problem.detail), PROTO_PROBLEM_DETAIL - 1);
    assert_int_equal(strlen(problem.pointer), PROTO_PROBLEM_POINTER - 1);
    proto_problem_descend(&problem, slashes);
    assert_int_equal(strlen(problem.pointer), PROTO_PROBLEM_POINTER - 1);
    proto_problem_refuse(&problem, "/a", "…");
    proto_problem_descend(&problem, slashes);
    assert_in_range(strlen(problem.pointer), PROTO_PROBLEM_POINTER - 4, PROTO_PROBLEM_POINTER - 1);
    slashes[0] = 'a';
    proto_problem_refuse(&problem, slashes, "…");
    assert_int_equal(strlen(problem.parameter), PROTO_PROBLEM_PARAMETER - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(encodes_applicable_members),
        cmocka_unit_test(encodes_elements),
        cmocka_unit_test(maps_every_status),
        cmocka_unit_test(hides_details_of_a_failed_self_check),
        cmocka_unit_test(encodes_retry_after),
        cmocka_unit_test(escapes_pointers),
        cmocka_unit_test(shortens_long_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
