#include "support.h"

#include "proto/values/uv.h"

/* Reads the list of a document at `place`, of at most `most` pairs. */
static bool take(const char *text, const char *place, uint32_t most, struct proto_uvs *out,
                 struct proto_problem *problem)
{
    const struct proto_rule rule = {.name = "list",
                                    .is_required = true,
                                    .least = 1,
                                    .most = most,
                                    .refusal = "expected pairs",
                                    .too_large = "too many pairs"};
    json_t *document = parse(text);
    const struct proto_object object = {document, place, problem};
    bool ok = proto_take_uvs(&object, &rule, out);
    json_decref(document);
    return ok;
}

static void pairs_are_read(void **state)
{
    struct proto_problem problem;
    struct proto_uvs uvs;
    (void)state;
    assert_true(take("{\"list\":[[1,2],[3,4],[5,6]]}", "", 3, &uvs, &problem));
    assert_int_equal(uvs.count, 3);
    assert_true(uvs.items[2][0] == 5 && uvs.items[2][1] == 6);
    proto_uvs_free(&uvs);
    proto_uvs_free(&uvs);
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {{"{}", "/in/list"},
                 {"{\"list\":3}", "/in/list"},
                 {"{\"list\":[]}", "/in/list"},
                 {"{\"list\":[[1,2],[3]]}", "/in/list/1"},
                 {"{\"list\":[[1,2],[3,4,5]]}", "/in/list/1"},
                 {"{\"list\":[[1,null]]}", "/in/list/0"},
                 {"{\"list\":[7]}", "/in/list/0"}};
    struct proto_problem problem;
    struct proto_uvs uvs = {NULL, 7};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_false(take(cases[i].body, "/in", 4, &uvs, &problem));
        assert_pointer(&problem, cases[i].pointer);
        assert_int_equal(uvs.count, 7);
    }
}

static void too_many_places_report_the_limit(void **state)
{
    struct proto_problem problem;
    struct proto_uvs uvs;
    (void)state;
    assert_false(take("{\"list\":[[1,2],[3,4],[5,6]]}", "", 2, &uvs, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_string_equal(problem.pointer, "/list");
    assert_int_equal(problem.limit, 2);
}

static void places_are_in_the_domain(void **state)
{
    struct gd_parametric *sheet, *torus;
    struct proto_problem problem;
    const double zero = 0, inside[2] = {0.5, 1}, outside[2] = {0.5, 1.5};
    (void)state;
    assert_int_equal(gd_parametric_graph(&(struct gd_graph){0, 0, &zero, (const double[]){0, 1},
                                                            (const double[]){0, 1}},
                                         &sheet, NULL),
                     GD_OK);
    assert_int_equal(gd_parametric_torus(2, 1, &torus, NULL), GD_OK);
    assert_true(proto_uv_check(sheet, inside, "/to", &problem));
    assert_true(proto_uv_check(torus, (const double[]){-99, 99}, "/to", &problem));
    assert_false(proto_uv_check(sheet, outside, "/to", &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_POINT_NOT_ON_SURFACE);
    assert_string_equal(problem.pointer, "/to");
    gd_parametric_release(sheet);
    gd_parametric_release(torus);
}

static void long_places_are_cut(void **state)
{
    char place[PROTO_PLACE], longer[PROTO_PLACE];
    (void)state;
    memset(place, 'a', sizeof place);
    place[sizeof place - 1] = '\0';
    proto_place_of_element(longer, place, 17);
    assert_string_equal(longer + strlen(longer) - 3, "/17");
    proto_place_of_member(longer, place, "knots");
    assert_string_equal(longer + strlen(longer) - 6, "/knots");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs_are_read),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(too_many_places_report_the_limit),
        cmocka_unit_test(places_are_in_the_domain),
        cmocka_unit_test(long_places_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
