#include "support.h"

#include "proto/http/route.h"

static const struct proto_route routes[] = {
    {.method = PROTO_METHOD_GET, .path = "/", .segments = {NULL}},
    {.method = PROTO_METHOD_GET,
     .path = "/v1/meshes",
     .segment_count = 2,
     .segments = {"v1", "meshes"}},
    {.method = PROTO_METHOD_POST,
     .path = "/v1/meshes",
     .segment_count = 2,
     .segments = {"v1", "meshes"}},
    {.method = PROTO_METHOD_GET,
     .path = "/v1/meshes/{name}",
     .segment_count = 3,
     .segments = {"v1", "meshes", NULL}},
    {.method = PROTO_METHOD_PUT,
     .path = "/v1/meshes/{name}",
     .segment_count = 3,
     .segments = {"v1", "meshes", NULL}},
    {.method = PROTO_METHOD_DELETE,
     .path = "/v1/meshes/{name}",
     .segment_count = 3,
     .segments = {"v1", "meshes", NULL}},
    {.method = PROTO_METHOD_GET,
     .path = "/v1/meshes/{name}/fields/{id}",
     .segment_count = 5,
     .segments = {"v1", "meshes", NULL, "fields", NULL}},
};

static bool find(const char *method, const char *path, struct proto_route_match *out,
                 struct proto_problem *problem)
{
    return proto_route_find(routes, COUNT(routes), method, path, out, problem);
}

static void finds_rows_and_captures(void **state)
{
    (void)state;
    struct proto_route_match match;
    struct proto_problem problem;
    assert_true(find("GET", "/", &match, &problem));
    assert_ptr_equal(match.route, &routes[0]);
    assert_int_equal(match.capture_count, 0);
    assert_true(find("POST", "/v1/meshes", &match, &problem));
    assert_ptr_equal(match.route, &routes[2]);
    assert_true(find("DELETE", "/v1/meshes/bunny", &match, &problem));
    assert_ptr_equal(match.route, &routes[5]);
    assert_int_equal(match.capture_count, 1);
    assert_int_equal(match.captures[0].length, 5);
    assert_memory_equal(match.captures[0].text, "bunny", 5);
    assert_true(find("GET", "/v1/meshes/a/fields/xyz", &match, &problem));
    assert_int_equal(match.capture_count, 2);
    assert_memory_equal(match.captures[0].text, "a/", 2);
    assert_memory_equal(match.captures[1].text, "xyz", 4);
}

static void answers_head_where_it_answers_get(void **state)
{
    (void)state;
    struct proto_route_match match;
    struct proto_problem problem;
    assert_true(find("HEAD", "/v1/meshes/bunny", &match, &problem));
    assert_ptr_equal(match.route, &routes[3]);
}

static void refuses_unknown_paths(void **state)
{
    (void)state;
    static const char *const paths[] = {
        "",
        "v1",
        "*",
        "//",
        "/v1",
        "/v1/",
        "/v1/mesh",
        "/v1/meshesx",
        "/v1/meshes/",
        "/v1//meshes",
        "/V1/meshes",
        "/v1/meshes/a/",
        "/v1/meshes/a/fields",
        "/v1/meshes//fields/b",
        "/v1/meshes/a/fields/b/c",
        "/1/2/3/4/5/6/7/8/9/10",
        "http://host/v1/meshes",
    };
    for (size_t i = 0; i < COUNT(paths); i++) {
        struct proto_route_match match = {.capture_count = 77};
        struct proto_problem problem;
        assert_false(find("GET", paths[i], &match, &problem));
        assert_int_equal(problem.code, PROTO_PROBLEM_NOT_FOUND);
        assert_int_equal(match.capture_count, 77);
    }
}

static void lists_the_methods_that_a_path_accepts(void **state)
{
    (void)state;
    static const struct {
        const char *method, *path, *allow;
    } cases[] = {
        {"POST", "/v1/meshes/bunny", "GET, HEAD, PUT, DELETE"},
        {"DELETE", "/v1/meshes", "GET, HEAD, POST"},
        {"PATCH", "/", "GET, HEAD"},
        {"get", "/", "GET, HEAD"},
        {"", "/", "GET, HEAD"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_route_match match;
        struct proto_problem problem;
        assert_false(find(cases[i].method, cases[i].path, &match, &problem));
        assert_int_equal(problem.code, PROTO_PROBLEM_METHOD_NOT_ALLOWED);
        assert_string_equal(problem.allow, cases[i].allow);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_rows_and_captures),
        cmocka_unit_test(answers_head_where_it_answers_get),
        cmocka_unit_test(refuses_unknown_paths),
        cmocka_unit_test(lists_the_methods_that_a_path_accepts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
