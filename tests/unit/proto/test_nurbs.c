#include "support.h"

#include "proto/queries/nurbs.h"

#define KNOTS  "\"knotsU\":[0,0,1,1],\"knotsV\":[0,0,1,1]"
#define POINTS "\"controlPoints\":[[[0,0,0],[0,1,0]],[[1,0,0],[1,1,1]]]"
#define SADDLE "{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS "}"

static bool read(const char *text, const struct proto_nurbs_options *options,
                 struct gd_parametric **out, struct proto_nurbs_form *form,
                 struct proto_problem *problem)
{
    static const struct proto_nurbs_options none;
    return proto_nurbs_read(text, strlen(text), options ? options : &none, out, form, problem);
}

static struct gd_vec3 middle_of(const char *text, const struct proto_nurbs_options *options)
{
    struct proto_problem problem;
    struct proto_nurbs_form form;
    struct gd_parametric *surface;
    struct gd_jet jet;
    assert_true(read(text, options, &surface, &form, &problem));
    assert_int_equal(gd_parametric_evaluate(surface, 0.5, 0.5, &jet), GD_OK);
    gd_parametric_release(surface);
    return jet.x;
}

static void a_file_is_a_surface(void **state)
{
    struct proto_problem problem;
    struct proto_nurbs_form form;
    struct gd_parametric *surface;
    (void)state;
    assert_true(read(SADDLE, NULL, &surface, &form, &problem));
    assert_string_equal(form.shape, "nurbs");
    assert_string_equal(form.convention, "canonical");
    assert_int_equal(form.degree[0] + form.degree[1], 2);
    assert_int_equal(form.count[0] + form.count[1], 4);
    assert_false(form.is_rational);
    gd_parametric_release(surface);
    assert_true(read("{\"parametric\":{\"torus\":{\"major\":2,\"minor\":1}}}", NULL, &surface,
                     &form, &problem));
    assert_string_equal(form.shape, "torus");
    assert_null(form.convention);
    gd_parametric_release(surface);
}

/* A weight of 3 at the last corner moves the middle towards this corner: z = (0 + 0 + 0 + 3 * 1) /
 * 6. */
static void reads_weights_in_each_convention(void **state)
{
    const struct proto_nurbs_options verb = {.has_convention = true, .convention = GD_NURBS_VERB};
    const char *forms[] = {
        "{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"weights\":[[1,1],[1,3]]}",
        "{\"degreeU\":1,\"degreeV\":1," KNOTS ",\"controlPoints\":[[[0,0,0,1],[0,1,0,1]],[[1,0,0,1]"
        ",[1,1,1,3]]],\"convention\":\"three\"}",
        "{\"degreeU\":1,\"degreeV\":1," KNOTS
        ",\"controlPoints\":[[[0,0,0,1],[0,1,0,1]],[[1,0,0,1],[3,3,3,3]]],\"convention\":\"verb\"}",
        "{\"degreeU\":1,\"degreeV\":1,\"knotsU\":[0,1],\"knotsV\":[0,1],\"controlPoints\":[[[0,0,0]"
        ",[0,1,0]],[[1,0,0],["
        "3,"
        "3,3]]],\"weights\":[[1,1],[1,3]],\"convention\":\"rhino\"}",
    };
    (void)state;
    for (size_t i = 0; i < COUNT(forms); i++)
        assert_true(gd_vec3_distance(middle_of(forms[i], NULL),
                                     (struct gd_vec3){4.0 / 6, 4.0 / 6, 0.5}) < 1e-15);
    assert_true(gd_vec3_distance(
                    middle_of("{\"degreeU\":1,\"degreeV\":1," KNOTS
                              ",\"controlPoints\":[[[0,0,0,1],[0,1,0,1]],[[1,0,0,1],[3,3,3,3]]]}",
                              &verb),
                    (struct gd_vec3){4.0 / 6, 4.0 / 6, 0.5}) < 1e-15);
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {
        {"", ""},
        {"{", ""},
        {"[1]", ""},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"name\":\"x\"}", "/name"},
        {"{\"degreeU\":\"1\"}", "/degreeU"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "}", "/controlPoints"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS ",\"controlPoints\":[[[0,0,0],[0,1,0]],[[1,0,0]]]}",
         "/controlPoints/1"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS
         ",\"controlPoints\":[[[0,0,0],[0,1]],[[1,0,0],[1,1,1]]]}",
         "/controlPoints/0/1"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"weights\":[[1,1]]}", "/weights"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"weights\":[[1,1],[1,\"1\"]]}",
         "/weights/1"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS ",\"controlPoints\":[[[0,0,0,1],[0,1,0,1]],[[1,0,0,"
         "1],[1,1,1,3]]],\"weights\":[[1,1],[1,1]]}",
         "/weights"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"convention\":\"maya\"}",
         "/convention"},
        {"{\"parametric\":{\"torus\":{\"major\":2,\"minor\":1}},\"degreeU\":1}", "/degreeU"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct proto_nurbs_form form = {.shape = "untouched"};
        struct gd_parametric *surface = NULL;
        assert_false(read(cases[i].body, NULL, &surface, &form, &problem));
        assert_pointer(&problem, cases[i].pointer);
        assert_null(surface);
        assert_string_equal(form.shape, "untouched");
    }
}

static void each_flaw_has_its_reason(void **state)
{
    static const struct {
        const char *body, *reason;
    } cases[] = {
        {"{\"degreeU\":1,\"degreeV\":1,\"knotsU\":[0,0,1,0],\"knotsV\":[0,0,1,1]," POINTS "}",
         "decreasing_knots"},
        {"{\"degreeU\":1,\"degreeV\":1,\"knotsU\":[0,0,1],\"knotsV\":[0,0,1,1]," POINTS "}",
         "knot_count"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"weights\":[[1,1],[1,-1]]}", "weight"},
        {"{\"degreeU\":16,\"degreeV\":1," KNOTS "," POINTS "}", "degree"},
        {"{\"degreeU\":2,\"degreeV\":1," KNOTS "," POINTS "}", "control_count"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"trimCurves\":[]}", "trimmed"},
        {"{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS
         ",\"trims\":{\"holes\":[[{\"polyline\":[[0.2,0.2],[0.4,0.2]]}]]}}",
         "trims"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct proto_nurbs_form form;
        struct gd_parametric *surface;
        assert_false(read(cases[i].body, NULL, &surface, &form, &problem));
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_MESH);
        assert_string_equal(problem.reason, cases[i].reason);
        assert_true(problem.detail[0] != '\0');
    }
}

static void options_are_a_convention(void **state)
{
    struct proto_nurbs_options options;
    struct proto_problem problem;
    struct proto_parameters verb = QUERY("convention", "verb", "format", "json"),
                            other = QUERY("convention", "maya"), mesh = QUERY("format", "obj"),
                            weld = QUERY("weld", "0"), none = NO_QUERY;
    (void)state;
    assert_true(proto_nurbs_options_parse(&none, &options, &problem));
    assert_false(options.has_convention);
    assert_true(proto_nurbs_options_parse(&verb, &options, &problem));
    assert_true(options.has_convention && options.convention == GD_NURBS_VERB);
    assert_false(proto_nurbs_options_parse(&other, &options, &problem));
    assert_parameter(&problem, "convention");
    assert_false(proto_nurbs_options_parse(&mesh, &options, &problem));
    assert_parameter(&problem, "format");
    assert_false(proto_nurbs_options_parse(&weld, &options, &problem));
    assert_parameter(&problem, "weld");
}

/* The query string and the file may both name the convention if they agree. */
static void one_of_two_conventions(void **state)
{
    const char *body = "{\"degreeU\":1,\"degreeV\":1," KNOTS "," POINTS ",\"convention\":\"verb\"}";
    const struct proto_nurbs_options verb = {.has_convention = true, .convention = GD_NURBS_VERB},
                                     three = {.has_convention = true, .convention = GD_NURBS_THREE};
    struct proto_problem problem;
    struct proto_nurbs_form form;
    struct gd_parametric *surface;
    (void)state;
    assert_true(read(body, &verb, &surface, &form, &problem));
    gd_parametric_release(surface);
    assert_false(read(body, &three, &surface, &form, &problem));
    assert_pointer(&problem, "/convention");
}

static void the_description(void **state)
{
    struct proto_problem problem;
    struct proto_nurbs_description description = {.name = "sheet",
                                                  .sha256 = "00",
                                                  .created = 0,
                                                  .etag = "tag",
                                                  .memory_bytes = 7,
                                                  .obstacle = "degenerate_face"};
    struct gd_parametric *surface;
    struct proto_writer writer = new_writer();
    (void)state;
    assert_true(read(SADDLE, NULL, &surface, &description.form, &problem));
    description.surface = surface;
    proto_nurbs_encode(&writer, &description);
    assert_written(&writer, "{\"name\":\"sheet\",\"sha256\":\"00\",\"shape\":\"nurbs\","
                            "\"convention\":\"canonical\",\"degree\":[1,1],"
                            "\"control_points\":[2,2],\"rational\":false,\"domain\":{\"u\":{"
                            "\"range\":[0,1],\"closed\":false,"
                            "\"pieces\":1,\"pole_low\":false,\"pole_high\":false},\"v\":{\"range\":"
                            "[0,1],\"closed\":false,"
                            "\"pieces\":1,\"pole_low\":false,\"pole_high\":false}},\"size\":1."
                            "7320508075688772,\"geodesics\":false,"
                            "\"reason\":\"degenerate_face\",\"memory_bytes\":7,\"created\":\"1970-"
                            "01-01T00:00:00Z\",\"etag\":\"tag\"}");
    gd_parametric_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_a_surface),
        cmocka_unit_test(reads_weights_in_each_convention),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(each_flaw_has_its_reason),
        cmocka_unit_test(options_are_a_convention),
        cmocka_unit_test(one_of_two_conventions),
        cmocka_unit_test(the_description),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
