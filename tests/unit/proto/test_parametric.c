#include "support.h"

#include <math.h>

#include "generated/answers.h"
#include "proto/values/parametric.h"

static bool read(const char *text, struct gd_parametric **out, const char **shape,
                 struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool ok = proto_parametric_decode(document, "/parametric", out, shape, problem);
    json_decref(document);
    return ok;
}

/* Checks each shape at one point. */
static void decodes_each_shape(void **state)
{
    const double c = cos(0.3), s = sin(0.3);
    const struct {
        const char *shape, *body;
        double v;
        struct gd_vec3 x;
    } cases[] = {{"torus",
                  "{\"torus\":{\"major\":2,\"minor\":1}}",
                  2,
                  {(2 + cos(2)) * c, (2 + cos(2)) * s, sin(2)}},
                 {"helicoid",
                  "{\"helicoid\":{\"pitch\":0.5,\"u\":[0,1],\"v\":[-1,2]}}",
                  2,
                  {2 * c, 2 * s, 0.15}},
                 {"graph",
                  "{\"graph\":{\"coefficients\":[[1,2],[0,3],[4,0]],\"u\":[0,1],\"v\":[0,3]}}",
                  2,
                  {0.3, 2, 1 + 4 + 1.8 + 0.36}},
                 {"revolution",
                  "{\"revolution\":{\"degree\":1,\"knots\":[0,0,1,1],\"control_points\":[[1,0],[2,"
                  "3]],\"weights\":[1,1]}}",
                  0.5,
                  {1.5 * c, 1.5 * s, 1.5}}};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct gd_parametric *surface;
        const char *shape;
        struct gd_jet jet;
        assert_true(read(cases[i].body, &surface, &shape, &problem));
        assert_string_equal(shape, cases[i].shape);
        assert_int_equal(gd_parametric_evaluate(surface, 0.3, cases[i].v, &jet), GD_OK);
        assert_true(gd_vec3_distance(jet.x, cases[i].x) < 1e-14);
        gd_parametric_release(surface);
    }
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {
        {"[]", "/parametric"},
        {"{}", "/parametric"},
        {"{\"cube\":{}}", "/parametric/cube"},
        {"{\"torus\":{\"major\":2,\"minor\":1},\"graph\":{}}", "/parametric"},
        {"{\"torus\":3}", "/parametric/torus"},
        {"{\"torus\":{\"major\":2}}", "/parametric/torus/minor"},
        {"{\"torus\":{\"major\":1,\"minor\":2}}", "/parametric/torus"},
        {"{\"torus\":{\"major\":1,\"minor\":2,\"twist\":0}}", "/parametric/torus/twist"},
        {"{\"helicoid\":{\"pitch\":1,\"u\":[1,0],\"v\":[0,1]}}", "/parametric/helicoid"},
        {"{\"helicoid\":{\"pitch\":1,\"u\":[0,1]}}", "/parametric/helicoid/v"},
        {"{\"graph\":{\"coefficients\":[],\"u\":[0,1],\"v\":[0,1]}}",
         "/parametric/graph/coefficients"},
        {"{\"graph\":{\"coefficients\":[[1,2],[3]],\"u\":[0,1],\"v\":[0,1]}}",
         "/parametric/graph/coefficients"},
        {"{\"graph\":{\"coefficients\":[[1,true]],\"u\":[0,1],\"v\":[0,1]}}",
         "/parametric/graph/coefficients"},
        {"{\"revolution\":{\"degree\":1,\"knots\":[0,1],\"control_points\":[[1,0],[2,3]]}}",
         "/parametric/revolution/knots"},
        {"{\"revolution\":{\"degree\":1,\"knots\":[0,0,1,1],\"control_points\":[[1,0],[2,3]],"
         "\"weights\":[1]}}",
         "/parametric/revolution/weights"},
        {"{\"revolution\":{\"degree\":1,\"knots\":[0,0,1,1],\"control_points\":[[1,0],[-2,3]]}}",
         "/parametric/revolution"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        struct gd_parametric *surface = NULL;
        const char *shape = NULL;
        assert_false(read(cases[i].body, &surface, &shape, &problem));
        assert_pointer(&problem, cases[i].pointer);
        assert_null(surface);
        assert_null(shape);
    }
}

static void encodes_the_domain(void **state)
{
    struct gd_parametric *cone;
    struct proto_problem problem;
    const char *shape;
    (void)state;
    assert_true(read("{\"revolution\":{\"degree\":1,\"knots\":[0,0,1,2,2],\"control_points\":[[0,0]"
                     ",[1,1],[1,2]]}}",
                     &cone, &shape, &problem));
    struct proto_writer writer = new_writer();
    proto_nurbs_axis_encode(&writer, gd_parametric_axis_u(cone));
    proto_nurbs_axis_encode(&writer, gd_parametric_axis_v(cone));
    assert_written(
        &writer,
        "{\"range\":[0,6.283185307179586],\"closed\":true,\"pieces\":1,\"pole_low\":false,"
        "\"pole_high\":false},{\"range\":[0,2],\"closed\":false,\"pieces\":2,\"pole_low\":true,"
        "\"pole_high\":false}");
    gd_parametric_release(cone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_each_shape),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(encodes_the_domain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
