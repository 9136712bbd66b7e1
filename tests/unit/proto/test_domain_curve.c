#include "support.h"

#include <math.h>

#include "proto/values/domain_curve.h"

static struct gd_parametric *new_torus(void)
{
    struct gd_parametric *torus;
    assert_int_equal(gd_parametric_torus(2, 1, &torus, NULL), GD_OK);
    return torus;
}

static struct gd_parametric *new_sheet(void)
{
    struct gd_parametric *sheet;
    const double zero = 0, range[] = {0, 1};
    assert_int_equal(
        gd_parametric_graph(&(struct gd_graph){0, 0, &zero, range, range}, &sheet, NULL), GD_OK);
    return sheet;
}

static bool read(const char *text, struct proto_domain_curve *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool ok = proto_domain_curve_decode_member(document, "a", out, problem);
    json_decref(document);
    return ok;
}

static struct gd_domain_curve *locate(const struct gd_parametric *surface, const char *text)
{
    struct proto_domain_curve curve;
    struct proto_problem problem;
    struct gd_domain_curve *located = NULL;
    assert_true(read(text, &curve, &problem));
    assert_true(proto_domain_curve_locate(surface, &curve, NULL, &located, &problem));
    proto_domain_curve_free(&curve);
    proto_domain_curve_free(&curve);
    return located;
}

static void check(const struct gd_parametric *surface, const char *text, bool closed, double low,
                  double high, double at, double u, double v)
{
    struct gd_domain_curve *curve = locate(surface, text);
    double range[2], uv[2];
    gd_domain_curve_range(curve, &range[0], &range[1]);
    gd_domain_curve_at(curve, at, uv);
    assert_int_equal(gd_domain_curve_is_closed(curve), closed);
    assert_true(fabs(range[0] - low) + fabs(range[1] - high) + fabs(uv[0] - u) + fabs(uv[1] - v) <
                1e-14);
    gd_domain_curve_release(curve);
}

static void curves_of_all_kinds(void **state)
{
    struct gd_parametric *torus = new_torus(), *sheet = new_sheet();
    (void)state;
    check(sheet, "{\"a\":{\"polyline\":[[0,0],[1,0],[1,1]]}}", false, 0, 2, 1.5, 1, 0.5);
    check(sheet, "{\"a\":{\"polyline\":[[0,0],[1,0],[1,1]],\"closed\":true}}", true, 0, 3, 2.5, 0.5,
          0.5);
    check(sheet, "{\"a\":{\"polyline\":[[0,0],[1,0],[1,1],[0,0]],\"closed\":true}}", true, 0, 3,
          2.5, 0.5, 0.5);
    check(torus, "{\"a\":{\"polyline\":[[0,1],[6.283185307179586,1]],\"closed\":true}}", true, 0, 1,
          0.5, M_PI, 1);
    check(sheet,
          "{\"a\":{\"bspline\":{\"degree\":2,\"knots\":[0,0,0,4,4,4],\"control_points\":[[0,0],[0."
          "5,1],[1,0]]}}}",
          false, 0, 4, 2, 0.5, 0.5);
    check(torus, "{\"a\":{\"iso\":\"u\",\"value\":1}}", true, 0, 2 * M_PI, 2, 1, 2);
    check(torus, "{\"a\":{\"iso\":\"v\",\"value\":1,\"range\":[-1,2]}}", false, -1, 2, 0.5, 0.5, 1);
    gd_parametric_release(torus);
    gd_parametric_release(sheet);
}

static void points_are_curves_too(void **state)
{
    struct gd_parametric *sheet = new_sheet();
    struct proto_problem problem;
    struct proto_domain_curve point;
    struct gd_domain_curve *located;
    json_t *document = parse("{\"p\":[0.5,1]}");
    (void)state;
    assert_true(proto_domain_curve_decode_point(document, "p", &point, &problem));
    assert_true(proto_domain_curve_locate(sheet, &point, NULL, &located, &problem));
    assert_true(gd_domain_curve_is_point(located));
    gd_domain_curve_release(located);
    point.polyline.items[0][1] = 2;
    assert_false(proto_domain_curve_locate(sheet, &point, NULL, &located, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_POINT_NOT_ON_SURFACE);
    assert_string_equal(problem.pointer, "/p");
    proto_domain_curve_free(&point);
    json_decref(document);
    gd_parametric_release(sheet);
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {
        {"{}", "/a"},
        {"{\"a\":[]}", "/a"},
        {"{\"a\":{\"arc\":1}}", "/a"},
        {"{\"a\":{\"polyline\":[[0,0]],\"iso\":\"u\"}}", "/a/iso"},
        {"{\"a\":{\"polyline\":[[0,0],0]}}", "/a/polyline/1"},
        {"{\"a\":{\"polyline\":[[0,0],[1,1]],\"closed\":1}}", "/a/closed"},
        {"{\"a\":{\"bspline\":{\"degree\":1,\"knots\":[0,0,1],\"control_points\":[[0,0],[1,1]]}}}",
         "/a/bspline/knots"},
        {"{\"a\":{\"bspline\":{\"degree\":1,\"weights\":[1]}}}", "/a/bspline/weights"},
        {"{\"a\":{\"iso\":1,\"value\":1}}", "/a/iso"},
        {"{\"a\":{\"iso\":\"u\"}}", "/a/value"},
        {"{\"a\":{\"iso\":\"u\",\"value\":0,\"range\":[1,1]}}", "/a/range"},
        {"{\"a\":{\"iso\":\"u\",\"value\":0,\"range\":[1]}}", "/a/range"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct proto_domain_curve curve;
        assert_false(read(cases[i].body, &curve, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

static void curves_that_do_not_lie_on_the_surface(void **state)
{
    static const struct {
        const char *body, *pointer;
        enum proto_problem_code code;
    } cases[] = {
        {"{\"a\":{\"polyline\":[[0,0],[0.5,0],[1,7]]}}", "/a/polyline/2",
         PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"a\":{\"bspline\":{\"degree\":1,\"knots\":[0,0,1,1],\"control_points\":[[-1,0],[1,1]]}}"
         "}",
         "/a/bspline/control_points/0", PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"a\":{\"polyline\":[[0,0]]}}", "/a", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"a\":{\"polyline\":[[0,0],[0,0]]}}", "/a", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"a\":{\"iso\":\"u\",\"value\":2}}", "/a", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"a\":{\"iso\":\"u\",\"value\":0,\"range\":[0,2]}}", "/a",
         PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"a\":{\"bspline\":{\"degree\":1,\"knots\":[0,0,1,1],\"control_points\":[[0,0],[1,1]]},"
         "\"closed\":true}}",
         "/a", PROTO_PROBLEM_INVALID_REQUEST},
    };
    struct gd_parametric *sheet = new_sheet();
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct proto_domain_curve curve;
        struct gd_domain_curve *located = NULL;
        assert_true(read(cases[i].body, &curve, &problem));
        assert_false(proto_domain_curve_locate(sheet, &curve, NULL, &located, &problem));
        assert_int_equal(problem.code, cases[i].code);
        assert_string_equal(problem.pointer, cases[i].pointer);
        assert_null(located);
        proto_domain_curve_free(&curve);
    }
    gd_parametric_release(sheet);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_of_all_kinds),
        cmocka_unit_test(points_are_curves_too),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(curves_that_do_not_lie_on_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
