#include "support.h"

#include <math.h>
#include <stdio.h>

#include "proto/values/set.h"

/* Decodes a set and locates it on the tetrahedron. Returns NULL with the problem on failure. */
static struct proto_located_set *locate(const char *text, struct proto_problem *problem)
{
    struct proto_set set;
    struct proto_located_set *located = NULL;
    struct gd_mesh *mesh = new_tetrahedron();
    json_t *document = parse(text);
    if (proto_set_decode(document, "/set", &set, problem)) {
        if (proto_set_locate(mesh, &set, NULL, &located, problem)) assert_null(located);
        proto_set_free(&set);
        proto_set_free(&set);
    }
    json_decref(document);
    gd_mesh_release(mesh);
    return located;
}

static void takes_points_of_all_forms(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_located_set *set =
        locate("{\"points\":[{\"vertex\":3},{\"edge\":[0,1],\"t\":0.25,\"offset\":2},"
               "{\"face\":1,\"barycentric\":[0.5,0.25,0.25],\"label\":\"hof\",\"offset\":0},"
               "{\"xyz\":[2,0,0],\"max_snap\":1,\"label\":\"\"},{\"ray\":{\"origin\":[-1,0.2,0.2],"
               "\"direction\":[1,0,0]}}]}",
               &problem);
    assert_non_null(set);
    assert_int_equal(set->count, 5);
    assert_int_equal(set->seeds[0].point.kind, GD_POINT_VERTEX);
    assert_int_equal(set->seeds[1].point.kind, GD_POINT_EDGE);
    assert_true(set->seeds[1].offset == 2 && set->seeds[0].offset == 0);
    assert_null(proto_located_set_label(set, 0));
    assert_string_equal(proto_located_set_label(set, 2), "hof");
    assert_string_equal(proto_located_set_label(set, 3), "");
    assert_null(proto_located_set_label(set, 4));
    free(set);
}

static void equal_sets_are_equal_bytes(void **state)
{
    (void)state;
    static const char text[] =
        "{\"points\":[{\"edge\":[0,1],\"t\":0.25,\"offset\":-0},{\"vertex\":2}]}";
    struct proto_problem problem;
    struct proto_located_set *a = locate(text, &problem), *b = locate(text, &problem);
    assert_memory_equal(a->seeds, b->seeds, a->count * sizeof *a->seeds);
    assert_false(signbit(a->seeds[0].offset));
    free(a);
    free(b);
}

static void refuses_invalid_sets(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"[]", "/set"},
        {"{}", "/set"},
        {"{\"points\":[]}", "/set"},
        {"{\"points\":{}}", "/set/points"},
        {"{\"points\":[{\"vertex\":0}],\"curves\":{}}", "/set/curves"},
        {"{\"curves\":[{\"boundary\":0}]}", "/set/curves/0"},
        {"{\"curves\":[{\"vertices\":[0,9]}]}", "/set/curves/0"},
        {"{\"curves\":[{\"spline\":{}}]}", "/set/curves/0/spline/points"},
        {"{\"curves\":[{\"vertices\":[0,1],\"offset\":-1}]}", "/set/curves/0/offset"},
        {"{\"boundaries\":[0]}", "/set/boundaries/0"},
        {"{\"boundaries\":\"all\"}", "/set/boundaries"},
        {"{\"boundaries\":\"some\"}", "/set/boundaries"},
        {"{\"points\":[{\"vertex\":0}],\"lines\":[]}", "/set/lines"},
        {"{\"points\":[{\"vertex\":0},7]}", "/set/points/1"},
        {"{\"points\":[{\"label\":\"a\"}]}", "/set/points/0"},
        {"{\"points\":[{\"vertex\":0,\"weight\":1,\"label\":\"a\"}]}", "/set/points/0/weight"},
        {"{\"points\":[{\"vertex\":0,\"offset\":-1}]}", "/set/points/0/offset"},
        {"{\"points\":[{\"vertex\":0,\"offset\":1e151}]}", "/set/points/0/offset"},
        {"{\"points\":[{\"vertex\":0,\"offset\":\"1\"}]}", "/set/points/0/offset"},
        {"{\"points\":[{\"vertex\":0,\"label\":1}]}", "/set/points/0/label"},
        {"{\"points\":[{\"vertex\":0},{\"vertex\":4}]}", "/set/points/1"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        assert_null(locate(cases[i].text, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

static void labels_are_bounded(void **state)
{
    (void)state;
    char text[512];
    struct proto_problem problem;
    snprintf(text, sizeof text, "{\"points\":[{\"vertex\":0,\"label\":\"%0*d\"}]}", PROTO_SET_LABEL,
             1);
    struct proto_located_set *set = locate(text, &problem);
    assert_non_null(set);
    assert_int_equal(strlen(proto_located_set_label(set, 0)), PROTO_SET_LABEL);
    free(set);
    snprintf(text, sizeof text, "{\"points\":[{\"vertex\":0,\"label\":\"%0*d\"}]}",
             PROTO_SET_LABEL + 1, 1);
    assert_null(locate(text, &problem));
    assert_pointer(&problem, "/set/points/0/label");
}

static void members_are_bounded(void **state)
{
    (void)state;
    static const char member[] = "{\"vertex\":0},";
    size_t size = sizeof "{\"points\":[" + (PROTO_SET_MEMBERS + 1) * (sizeof member - 1) + 2;
    char *text = test_malloc(size), *end = stpcpy(text, "{\"points\":[");
    struct proto_problem problem;
    for (int i = 0; i <= PROTO_SET_MEMBERS; i++) end = stpcpy(end, member);
    strcpy(end - 1, "]}");
    assert_null(locate(text, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, PROTO_SET_MEMBERS);
    assert_string_equal(problem.pointer, "/set/points");
    test_free(text);
}

/* Points come first, then curves. A curve becomes one seed for each point and one seed for each
 * segment. */
static void curves_are_members(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_located_set *set = locate(
        "{\"curves\":[{\"vertices\":[0,1,2],\"closed\":true,\"label\":\"ring\",\"offset\":3},"
        "{\"points\":[{\"vertex\":3}]}],\"points\":[{\"vertex\":1,\"label\":\"dot\"}]}",
        &problem);
    static const uint32_t members[] = {0, 1, 1, 1, 1, 1, 1, 2};
    assert_non_null(set);
    assert_int_equal(set->count, 3);
    assert_int_equal(set->seed_count, COUNT(members));
    assert_true(set->has_segments);
    assert_memory_equal(set->members, members, sizeof members);
    for (uint32_t i = 0; i < set->seed_count; i++) {
        assert_true(set->seeds[i].is_segment == (i == 2 || i == 4 || i == 6));
        assert_true(set->seeds[i].offset == (members[i] == 1 ? 3 : 0));
    }
    assert_true(gd_point_equal(&set->seeds[6].end, &set->seeds[1].point));
    assert_string_equal(proto_located_set_label(set, 0), "dot");
    assert_string_equal(proto_located_set_label(set, 1), "ring");
    assert_null(proto_located_set_label(set, 2));
    free(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_points_of_all_forms), cmocka_unit_test(equal_sets_are_equal_bytes),
        cmocka_unit_test(refuses_invalid_sets),      cmocka_unit_test(labels_are_bounded),
        cmocka_unit_test(members_are_bounded),       cmocka_unit_test(curves_are_members),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
