#include "support.h"

#include <math.h>

#include "proto/queries/isoline.h"

/* --- the request ------------------------------------------------------------------------------ */

static bool decode(const char *text, struct proto_isolines *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool ok = proto_isolines_decode(document, out, problem);
    json_decref(document);
    return ok;
}

static void reads_both_forms(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        struct proto_isolines isolines;
        struct proto_problem problem;
        struct proto_parameters levels = QUERY("levels", "0.5,1e-3,2", "arcs", "true");
        struct proto_parameters count = QUERY("count", "7", "tolerance", "0.25");
        assert_true(form ? decode("{\"levels\":[0.5,1e-3,2],\"arcs\":true}", &isolines, &problem)
                         : proto_isolines_parse(&levels, &isolines, &problem));
        assert_int_equal(isolines.level_count, 3);
        assert_true(isolines.levels[0] == 0.5 && isolines.levels[1] == 1e-3 &&
                    isolines.levels[2] == 2);
        assert_true(isolines.wants_arcs && isolines.tolerance == 0);
        proto_isolines_free(&isolines);
        proto_isolines_free(&isolines);
        assert_true(form ? decode("{\"count\":7,\"tolerance\":0.25}", &isolines, &problem)
                         : proto_isolines_parse(&count, &isolines, &problem));
        assert_int_equal(isolines.level_count, 7);
        assert_null(isolines.levels);
        assert_true(!isolines.wants_arcs && isolines.tolerance == 0.25);
        proto_isolines_free(&isolines);
    }
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"[]", ""},
        {"{}", ""},
        {"{\"levels\":[1],\"count\":1}", ""},
        {"{\"levels\":3}", "/levels"},
        {"{\"levels\":[]}", "/levels"},
        {"{\"levels\":[1,-1]}", "/levels"},
        {"{\"levels\":[1,null]}", "/levels/1"},
        {"{\"count\":0}", "/count"},
        {"{\"count\":\"2\"}", "/count"},
        {"{\"count\":2,\"tolerance\":-1}", "/tolerance"},
        {"{\"count\":2,\"tolerance\":true}", "/tolerance"},
        {"{\"count\":2,\"arcs\":1}", "/arcs"},
        {"{\"count\":2,\"levle\":1}", "/levle"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_isolines isolines;
        struct proto_problem problem;
        assert_false(decode(cases[i][0], &isolines, &problem));
        assert_pointer(&problem, cases[i][1]);
    }
}

static void refuses_bad_query_strings(void **state)
{
    (void)state;
    static const struct {
        const char *pairs[5], *parameter;
    } cases[] = {
        {{NULL}, "levels"},
        {{"levels", "1", "count", "1", NULL}, "levels"},
        {{"levels", "", NULL}, "levels"},
        {{"levels", ",", NULL}, "levels"},
        {{"levels", "1,", NULL}, "levels"},
        {{"levels", "1 2", NULL}, "levels"},
        {{"levels", "1,x", NULL}, "levels"},
        {{"levels", "1,-2", NULL}, "levels"},
        {{"count", "0", NULL}, "count"},
        {{"count", "x", NULL}, "count"},
        {{"count", "1", "tolerance", "", NULL}, "tolerance"},
        {{"count", "1", "tolerance", "0", NULL}, "tolerance"},
        {{"count", "1", "tolerance", "1m", NULL}, "tolerance"},
        {{"count", "1", "arcs", "1", NULL}, "arcs"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_isolines isolines;
        struct proto_problem problem;
        struct proto_parameters parameters = query_of(cases[i].pairs);
        assert_false(proto_isolines_parse(&parameters, &isolines, &problem));
        assert_parameter(&problem, cases[i].parameter);
    }
}

static void too_many_levels_are_too_large(void **state)
{
    (void)state;
    struct proto_isolines isolines;
    struct proto_problem problem;
    char text[2 * PROTO_ISOLINES_LEVELS + 2];
    for (int i = 0; i <= PROTO_ISOLINES_LEVELS; i++) memcpy(text + 2 * i, "1,", 2);
    text[sizeof text - 1] = '\0';
    struct proto_parameters levels = QUERY("levels", text), count = QUERY("count", "1001");
    assert_false(proto_isolines_parse(&levels, &isolines, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_false(proto_isolines_parse(&count, &isolines, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_true(problem.has_limit && problem.limit == PROTO_ISOLINES_LEVELS);
    assert_string_equal(problem.parameter, "count");
    text[2 * PROTO_ISOLINES_LEVELS - 1] = '\0';
    assert_true(proto_isolines_parse(&levels, &isolines, &problem));
    assert_int_equal(isolines.level_count, PROTO_ISOLINES_LEVELS);
    proto_isolines_free(&isolines);
}

static void fits_levels_to_the_field(void **state)
{
    (void)state;
    const struct proto_field_description whole = {.max = 2},
                                         partial = {.max = NAN, .max_distance = 1};
    struct proto_isolines isolines;
    struct proto_problem problem;
    assert_true(decode("{\"count\":3}", &isolines, &problem));
    assert_true(proto_isolines_settle(&isolines, &whole, &problem));
    assert_true(isolines.levels[0] == 0.5 && isolines.levels[1] == 1 && isolines.levels[2] == 1.5);
    proto_isolines_free(&isolines);
    assert_true(decode("{\"count\":1}", &isolines, &problem));
    assert_true(proto_isolines_settle(&isolines, &partial, &problem));
    assert_true(isolines.levels[0] == 0.5);
    proto_isolines_free(&isolines);
    assert_true(decode("{\"levels\":[1,1.5]}", &isolines, &problem));
    assert_true(proto_isolines_settle(&isolines, &whole, &problem));
    assert_false(proto_isolines_settle(&isolines, &partial, &problem));
    assert_pointer(&problem, "/levels");
    assert_non_null(strstr(problem.detail, "level 1.5 is beyond the field's max_distance, 1,"));
    proto_isolines_free(&isolines);
}

static void the_tolerance_is_a_part_of_the_mesh(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    assert_true(fabs(proto_isolines_tolerance(0, mesh) - sqrt(3) / 2000) < 1e-18);
    assert_true(proto_isolines_tolerance(7, mesh) == 7);
    gd_mesh_release(mesh);
}

/* --- the answer ------------------------------------------------------------------------------- */

/* The start angle is reduced to [0, 2 pi). Straight arcs have no angles. */
static void encodes_arcs(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_isoline_arc arc = {
        .face = {1}, .radius = 2, .from = -2 * M_PI, .to = -2 * M_PI + 0.5, .centre = {1, 2, 3}};
    struct proto_writer writer = new_writer();
    proto_arc_encode(&writer, mesh, &arc);
    assert_written(&writer, "{\"face\":1,\"centre\":[1,2,3],\"radius\":2,\"start\":0,\"end\":0.5}");
    struct gd_isoline_arc straight = {.face = {2}, .u = 1, .to = 3, .centre = {1, 0, 0}};
    writer = new_writer();
    proto_arc_encode(&writer, mesh, &straight);
    assert_written(&writer, "{\"face\":2,\"straight\":true}");
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_both_forms),
        cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(refuses_bad_query_strings),
        cmocka_unit_test(too_many_levels_are_too_large),
        cmocka_unit_test(fits_levels_to_the_field),
        cmocka_unit_test(the_tolerance_is_a_part_of_the_mesh),
        cmocka_unit_test(encodes_arcs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
