#include "support.h"

#include <stdio.h>

#include "proto/values/curve.h"

static struct proto_curve decoded; /* the decoded curve must outlive the located curve */

/* Decodes a curve and locates it on the tetrahedron. */
static bool locate(const char *text, struct proto_located_curve *out, struct proto_problem *problem)
{
    struct gd_mesh *mesh = new_tetrahedron();
    json_t *document = parse(text);
    bool ok = proto_curve_decode(document, "/curve", &decoded, problem) &&
              proto_curve_locate(mesh, &decoded, out, problem);
    json_decref(document);
    gd_mesh_release(mesh);
    return ok;
}

static void takes_points(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_located_curve curve;
    assert_true(locate("{\"points\":[{\"vertex\":3},{\"edge\":[0,1],\"t\":0.25},{\"xyz\":[0.2,0.2,"
                       "0]}],\"closed\":true}",
                       &curve, &problem));
    assert_int_equal(curve.request.kind, GD_CURVE_POINTS);
    assert_int_equal(curve.request.count, 3);
    assert_true(curve.request.closed);
    assert_int_equal(curve.request.points[1].kind, GD_POINT_EDGE);
    assert_string_equal(decoded.place, "/curve");
    proto_located_curve_free(&curve);
    proto_located_curve_free(&curve);
    proto_curve_free(&decoded);
    proto_curve_free(&decoded);
}

static void takes_vertices(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_located_curve curve;
    assert_true(locate("{\"vertices\":[2,0,3]}", &curve, &problem));
    assert_int_equal(curve.request.kind, GD_CURVE_VERTICES);
    assert_int_equal(curve.request.count, 3);
    assert_false(curve.request.closed);
    assert_int_equal(curve.request.vertices[0].index, 2);
    assert_int_equal(curve.request.vertices[2].index, 3);
    proto_located_curve_free(&curve);
    proto_curve_free(&decoded);
}

static void takes_a_boundary(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_located_curve curve;
    assert_true(locate("{\"boundary\":7}", &curve, &problem));
    assert_int_equal(curve.request.kind, GD_CURVE_BOUNDARY);
    assert_int_equal(curve.request.boundary, 7);
    proto_located_curve_free(&curve);
}

static void refuses_invalid_curves(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } wrong[] = {
        {"{}", "/curve"},
        {"[]", "/curve"},
        {"{\"closed\":true}", "/curve"},
        {"{\"points\":[{\"vertex\":0}],\"boundary\":0}", "/curve"},
        {"{\"points\":3}", "/curve/points"},
        {"{\"points\":[]}", "/curve/points"},
        {"{\"points\":[{\"vertex\":0},{}]}", "/curve/points/1"},
        {"{\"points\":[{\"vertex\":0}],\"closed\":0}", "/curve/closed"},
        {"{\"vertices\":[]}", "/curve/vertices"},
        {"{\"vertices\":[0,1.5]}", "/curve/vertices/1"},
        {"{\"boundary\":-1}", "/curve/boundary"},
        {"{\"boundary\":0,\"closed\":false}", "/curve/closed"},
        {"{\"spline\":{\"points\":[]}}", "/curve/spline/points"},
        {"{\"spline\":{\"points\":[{\"vertex\":0},{\"vertex\":1}]},\"closed\":true}",
         "/curve/closed"},
        {"{\"polyline\":[]}", "/curve/polyline"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct proto_problem problem;
        struct proto_located_curve curve;
        assert_false(locate(wrong[i].text, &curve, &problem));
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_REQUEST);
        assert_string_equal(problem.pointer, wrong[i].pointer);
    }
}

static void refuses_too_many(void **state)
{
    (void)state;
    static char text[32 * (PROTO_CURVE_POINTS_MOST + 2)];
    struct proto_problem problem;
    struct proto_located_curve curve;
    char *end = stpcpy(text, "{\"points\":[{\"vertex\":0}");
    for (int i = 0; i < PROTO_CURVE_POINTS_MOST; i++) end = stpcpy(end, ",{\"vertex\":0}");
    strcpy(end, "]}");
    assert_false(locate(text, &curve, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, PROTO_CURVE_POINTS_MOST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_points),     cmocka_unit_test(takes_vertices),
        cmocka_unit_test(takes_a_boundary), cmocka_unit_test(refuses_invalid_curves),
        cmocka_unit_test(refuses_too_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
