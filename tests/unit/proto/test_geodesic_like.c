#include "support.h"

#include <math.h>

#include "proto/queries/geodesic_like.h"

static bool read(const char *text, const struct proto_geodesic_form *form,
                 struct proto_geodesic *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool ok = proto_geodesic_decode(document, form, out, problem);
    json_decref(document);
    return ok;
}

static void requests_are_read(void **state)
{
    struct proto_geodesic wanted;
    struct proto_problem problem;
    (void)state;
    assert_true(
        read("{\"from\":[0,0],\"to\":[1,0]}", &proto_geodesic_between_points, &wanted, &problem));
    assert_int_equal(wanted.samples, 65);
    assert_true(wanted.options.degree == 3 && wanted.options.tolerance == 1e-11 &&
                !wanted.options.all_minima);
    proto_geodesic_free(&wanted);
    proto_geodesic_free(&wanted);
    assert_true(read(
        "{\"point\":[0,0],\"curve\":{\"iso\":\"u\",\"value\":1},\"degree\":2,\"control_points\":3,"
        "\"tolerance\":1e-6,\"all_minima\":true,\"samples\":2}",
        &proto_geodesic_to_curve, &wanted, &problem));
    assert_int_equal(wanted.ends[0].form, PROTO_DOMAIN_CURVE_POINT);
    assert_int_equal(wanted.ends[1].form, PROTO_DOMAIN_CURVE_ISO);
    assert_int_equal(wanted.options.degree, 2);
    assert_int_equal(wanted.options.control_points, 3);
    assert_true(wanted.options.tolerance == 1e-6 && wanted.options.all_minima &&
                wanted.samples == 2);
    assert_int_equal(wanted.options.turn_limit, 1);
    proto_geodesic_free(&wanted);
    assert_true(read("{\"from\":[0,0],\"to\":[1,0],\"turns\":[-2,1]}",
                     &proto_geodesic_between_points, &wanted, &problem));
    assert_true(wanted.has_turns && !wanted.has_initial);
    assert_true(wanted.turns[0] == -2 && wanted.turns[1] == 1);
    proto_geodesic_free(&wanted);
    assert_true(read("{\"from\":[0,0],\"to\":[1,0],\"initial\":{\"polyline\":[[0,0],[1,0]]}}",
                     &proto_geodesic_between_points, &wanted, &problem));
    assert_true(wanted.has_initial && wanted.initial.form == PROTO_DOMAIN_CURVE_POLYLINE);
    proto_geodesic_free(&wanted);
}

static void errors_have_pointers(void **state)
{
    static const struct {
        const char *body, *pointer;
    } cases[] = {
        {"{\"a\":{\"iso\":\"u\",\"value\":1}}", "/b"},
        {"{\"b\":{\"iso\":\"u\",\"value\":1}}", "/a"},
        {"{\"a\":[0,0],\"b\":[0,0]}", "/a"},
        {"{\"a\":1,\"b\":1,\"curve\":1}", "/curve"},
        {"{\"a\":{\"iso\":\"u\",\"value\":1},\"b\":{\"iso\":\"u\",\"value\":1},\"degree\":6}",
         "/degree"},
        {"{\"a\":1,\"b\":1,\"control_points\":3}", "/control_points"},
        {"{\"a\":1,\"b\":1,\"control_points\":4097}", "/control_points"},
        {"{\"a\":1,\"b\":1,\"tolerance\":2}", "/tolerance"},
        {"{\"a\":1,\"b\":1,\"samples\":1.5}", "/samples"},
        {"{\"a\":1,\"b\":1,\"all_minima\":\"no\"}", "/all_minima"},
        {"{\"a\":1,\"b\":1,\"turn_limit\":5}", "/turn_limit"},
        {"{\"a\":1,\"b\":1,\"turns\":[1]}", "/turns"},
        {"{\"a\":1,\"b\":1,\"turns\":[1,0.5]}", "/turns"},
        {"{\"a\":1,\"b\":1,\"turns\":[1,17]}", "/turns"},
        {"{\"a\":1,\"b\":1,\"turns\":[1,0],\"all_minima\":true}", "/turns"},
        {"{\"a\":1,\"b\":1,\"initial\":{},\"all_minima\":true}", "/initial"},
        {"{\"a\":1,\"b\":1,\"initial\":{}}", "/initial"}};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_geodesic wanted;
        struct proto_problem problem;
        assert_false(read(cases[i].body, &proto_geodesic_between_curves, &wanted, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

/* --- the answer: from made-up paths on a sheet ------------------------------------------------ */

static struct gd_parametric *new_sheet(void)
{
    struct gd_parametric *sheet;
    const double zero = 0, range[] = {0, 1};
    assert_int_equal(
        gd_parametric_graph(&(struct gd_graph){0, 0, &zero, range, range}, &sheet, NULL), GD_OK);
    return sheet;
}

static void check_answer(const char *request, const struct proto_geodesic_form *form,
                         struct gd_geodesics *found, struct proto_options options,
                         const char *expected)
{
    struct gd_parametric *sheet = new_sheet();
    struct proto_geodesic wanted;
    struct proto_problem problem;
    struct gd_domain_curve *ends[2];
    struct proto_writer writer = new_writer();
    assert_true(read(request, form, &wanted, &problem));
    for (int k = 0; k < 2; k++)
        assert_true(proto_domain_curve_locate(sheet, &wanted.ends[k], NULL, &ends[k], &problem));
    const struct proto_geodesic_answer answer = {&wanted, {ends[0], ends[1]}, found};
    assert_int_equal(proto_geodesic_encode(&writer, &answer, &options), GD_OK);
    assert_written(&writer, expected);
    for (int k = 0; k < 2; k++) gd_domain_curve_release(ends[k]);
    proto_geodesic_free(&wanted);
    gd_parametric_release(sheet);
}

static double knots[] = {0, 0, 0, 1, 1, 1};
static double first[][2] = {{0, 0}, {0.25, 0}, {0.5, 0}},
              second[][2] = {{0.5, 0}, {0.75, 0}, {1, 0}},
              apart[][2] = {{0.5, 0.5}, {0.75, 0}, {1, 0}};

static void encodes_a_path(void **state)
{
    struct gd_geodesic_piece piece = {2, 3, knots, first};
    struct gd_geodesic item = {.length = 0.5,
                               .error = 1e-12,
                               .from_angle = M_PI_2,
                               .to_angle = 1,
                               .to_parameter = 0.5,
                               .residual = 1e-9,
                               .iterations = 4,
                               .is_minimum = true,
                               .warnings = GD_GEODESIC_CURVE_CORNER,
                               .turns = {1, 0},
                               .piece_count = 1,
                               .pieces = &piece};
    (void)state;
    check_answer(
        "{\"point\":[0,0],\"curve\":{\"iso\":\"u\",\"value\":0.5},\"samples\":2}",
        &proto_geodesic_to_curve, &(struct gd_geodesics){1, &item},
        (struct proto_options){.names = proto_geodesic_fields, .fields = UINT32_MAX},
        "{\"length\":0.5,\"degree\":2,\"knots\":[0,0,0,1,1,1],\"control_points\":[[0,0],[0.25,0],["
        "0.5,0]],"
        "\"points\":[{\"uv\":[0,0],\"xyz\":[0,0,0]},{\"uv\":[0.5,0],\"xyz\":[0.5,0,0]}],"
        "\"ends\":{\"curve\":{\"parameter\":0.5,\"uv\":[0.5,0.5],\"xyz\":[0.5,0.5,0],\"angle\":1}},"
        "\"residual\":1e-9,\"error_estimate\":1e-12,\"geodesic_curvature\":0,\"speed_defect\":0,"
        "\"iterations\":4,"
        "\"converged\":true,\"is_minimum\":true,\"boundary_contact\":false,\"warnings\":[\"curve_"
        "corner\"],\"turns\":[1,0]}");
}

/* Pieces share the control point where they meet. If two pieces meet in space but not in the
 * domain, both control points are written, and the knot is repeated once more. */
static void pieces_are_encoded_as_one_spline(void **state)
{
    struct gd_geodesic_piece joined[] = {{2, 3, knots, first}, {2, 3, knots, second}},
                             split[] = {{2, 3, knots, first}, {2, 3, knots, apart}};
    struct gd_geodesic item = {.length = 1, .piece_count = 2, .pieces = joined};
    const struct proto_options options = {.names = proto_geodesic_fields,
                                          .fields = PROTO_GEODESIC_FIELD_KNOTS |
                                                    PROTO_GEODESIC_FIELD_CONTROL_POINTS};
    (void)state;
    check_answer(
        "{\"from\":[0,0],\"to\":[1,0]}", &proto_geodesic_between_points,
        &(struct gd_geodesics){1, &item}, options,
        "{\"knots\":[0,0,0,1,1,2,2,2],\"control_points\":[[0,0],[0.25,0],[0.5,0],[0.75,0],[1,0]]}");
    item.pieces = split;
    check_answer("{\"from\":[0,0],\"to\":[1,0]}", &proto_geodesic_between_points,
                 &(struct gd_geodesics){1, &item}, options,
                 "{\"knots\":[0,0,0,1,1,1,2,2,2],\"control_points\":[[0,0],[0.25,0],[0.5,0],[0.5,0."
                 "5],[0.75,0],[1,0]]}");
}

static void encodes_the_point_where_curves_meet(void **state)
{
    struct gd_geodesic item = {
        .from_parameter = 0.5, .to_parameter = 0.25, .is_minimum = true, .meeting = {0.25, 0.5}};
    (void)state;
    check_answer(
        "{\"a\":{\"iso\":\"u\",\"value\":0.25},\"b\":{\"iso\":\"v\",\"value\":0.5}}",
        &proto_geodesic_between_curves, &(struct gd_geodesics){1, &item},
        (struct proto_options){.names = proto_geodesic_fields,
                               .fields = PROTO_GEODESIC_FIELD_LENGTH |
                                         PROTO_GEODESIC_FIELD_CONTROL_POINTS |
                                         PROTO_GEODESIC_FIELD_DEGREE | PROTO_GEODESIC_FIELD_POINTS |
                                         PROTO_GEODESIC_FIELD_ENDS,
                               .geometry = PROTO_GEOMETRY_XYZ},
        "{\"length\":0,\"control_points\":[],\"points\":[[0.25,0.5,0]],\"ends\":{"
        "\"a\":{\"parameter\":0.5,\"uv\":[0.25,0.5],\"xyz\":[0.25,0.5,0],\"angle\":null},"
        "\"b\":{\"parameter\":0.25,\"uv\":[0.25,0.5],\"xyz\":[0.25,0.5,0],\"angle\":null}}}");
}

/* Paths that are not proved to be minima are omitted from `minima`. */
static void encodes_minima(void **state)
{
    struct gd_geodesic_piece piece = {2, 3, knots, first};
    struct gd_geodesic items[] = {
        {.length = 1, .is_minimum = true, .piece_count = 1, .pieces = &piece},
        {.length = 2,
         .is_minimum = false,
         .piece_count = 1,
         .pieces = &piece,
         .warnings = GD_GEODESIC_NOT_MINIMAL},
        {.length = 3,
         .is_minimum = true,
         .piece_count = 1,
         .pieces = &piece,
         .warnings = GD_GEODESIC_NOT_CONVERGED}};
    const struct proto_options options = {
        .names = proto_geodesic_fields,
        .fields = PROTO_GEODESIC_FIELD_LENGTH | PROTO_GEODESIC_FIELD_CONVERGED |
                  PROTO_GEODESIC_FIELD_WARNINGS | PROTO_GEODESIC_FIELD_MINIMA};
    (void)state;
    check_answer("{\"from\":[0,0],\"to\":[1,0],\"all_minima\":true}",
                 &proto_geodesic_between_points, &(struct gd_geodesics){3, items}, options,
                 "{\"length\":1,\"converged\":true,\"warnings\":[],\"minima\":[{\"length\":1,"
                 "\"converged\":true,"
                 "\"warnings\":[]},"
                 "{\"length\":3,\"converged\":false,\"warnings\":[\"not_converged\"]}]}");
    check_answer("{\"from\":[0,0],\"to\":[1,0]}", &proto_geodesic_between_points,
                 &(struct gd_geodesics){1, items + 1}, options,
                 "{\"length\":2,\"converged\":true,\"warnings\":[\"not_minimal\"]}");
}

static void names_of_fields_match_their_bits(void **state)
{
    (void)state;
    assert_string_equal(proto_geodesic_fields[__builtin_ctz(PROTO_GEODESIC_FIELD_MINIMA)],
                        "minima");
    assert_string_equal(proto_geodesic_fields[__builtin_ctz(PROTO_GEODESIC_FIELD_ITERATIONS)],
                        "iterations");
    assert_string_equal(proto_geodesic_fields[__builtin_ctz(PROTO_GEODESIC_FIELD_ENDS)], "ends");
    assert_null(proto_geodesic_fields[__builtin_ctz(PROTO_GEODESIC_FIELD_MINIMA) + 1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requests_are_read),
        cmocka_unit_test(errors_have_pointers),
        cmocka_unit_test(encodes_a_path),
        cmocka_unit_test(pieces_are_encoded_as_one_spline),
        cmocka_unit_test(encodes_the_point_where_curves_meet),
        cmocka_unit_test(encodes_minima),
        cmocka_unit_test(names_of_fields_match_their_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
