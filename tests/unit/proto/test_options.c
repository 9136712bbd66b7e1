#include "support.h"

static const char *const fields[] = {"distance", "from", "to", NULL};
static const char *const common[] = {"timeout_ms", "select", "geometry", NULL};
static const char *const names[] = {"from", "to", "timeout_ms", "select", "geometry", NULL};
static const char *const few[] = {"from", "timeout_ms", NULL};

static void reads_the_options(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = NO_QUERY;
    assert_true(proto_options_parse(&parameters, fields, common, &options, &problem));
    assert_int_equal(options.fields, 7);
    assert_int_equal(options.geometry, PROTO_GEOMETRY_FULL);
    assert_int_equal(options.timeout_ms, 0);
    parameters = QUERY("from", "v:1", "select", "to,distance", "geometry", "xyz", "timeout_ms",
                       "250", "to", "v:2");
    assert_true(proto_options_parse(&parameters, fields, names, &options, &problem));
    assert_int_equal(options.fields, 5);
    assert_int_equal(options.geometry, PROTO_GEOMETRY_XYZ);
    assert_int_equal(options.timeout_ms, 250);
    parameters = QUERY("geometry", "none", "select", "to,to");
    assert_true(proto_options_parse(&parameters, fields, names, &options, &problem));
    assert_int_equal(options.fields, 4);
    assert_int_equal(options.geometry, PROTO_GEOMETRY_NONE);
}

static void refuses_bad_values(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"select", ""},
        {"select", ","},
        {"select", "distance,"},
        {"select", ",distance"},
        {"select", "Distance"},
        {"select", "dist"},
        {"select", "distance,path"},
        {"select", "distances"},
        {"select", "distance to"},
        {"geometry", ""},
        {"geometry", "XYZ"},
        {"geometry", "fully"},
        {"geometry", "ful"},
        {"timeout_ms", ""},
        {"timeout_ms", "0"},
        {"timeout_ms", "-1"},
        {"timeout_ms", "1.5"},
        {"timeout_ms", "1e3"},
        {"timeout_ms", "10s"},
        {"timeout_ms", " 10"},
        {"timeout_ms", "86400001"},
        {"timeout_ms", "99999999999999999999"},
        {"format", "obj"},
        {"from", "v:1"},
        {"Geometry", "full"},
        {"/from", "v:1"},
        {"", ""},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_options options = {.timeout_ms = 7};
        struct proto_problem problem;
        struct proto_parameters parameters = QUERY(cases[i][0], cases[i][1]);
        assert_false(proto_options_parse(&parameters, fields, common, &options, &problem));
        assert_parameter(&problem, cases[i][0]);
        assert_int_equal(options.timeout_ms, 7);
    }
}

static void operations_without_fields_refuse_select(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("from", "v:1", "timeout_ms", "250");
    assert_true(proto_options_parse(&parameters, NULL, few, &options, &problem));
    assert_int_equal(options.timeout_ms, 250);
    parameters = QUERY("select", "distance");
    assert_false(proto_options_parse(&parameters, NULL, few, &options, &problem));
    assert_parameter(&problem, "select");
    parameters = QUERY("geometry", "xyz");
    assert_false(proto_options_parse(&parameters, NULL, few, &options, &problem));
    assert_parameter(&problem, "geometry");
}

static void errors_list_the_choices(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("geometry", "round");
    assert_false(proto_options_parse(&parameters, fields, common, &options, &problem));
    assert_string_equal(problem.detail, "expected one of: full xyz none");
    parameters = QUERY("select", "to,path");
    assert_false(proto_options_parse(&parameters, fields, common, &options, &problem));
    assert_string_equal(problem.detail,
                        "the answer has no member \"path\"; it has distance from to");
}

static void the_progress_of_the_whole_covers_all_parts(void **state)
{
    (void)state;
    enum { OTHER = 1, WHOLE = 2, PARTS = 4 | 8 };
    assert_int_equal(proto_fields_within(OTHER | WHOLE | PARTS, WHOLE, PARTS), PARTS);
    assert_int_equal(proto_fields_within(OTHER | WHOLE, WHOLE, PARTS), PARTS);
    assert_int_equal(proto_fields_within(WHOLE | 8, WHOLE, PARTS), 8);
    assert_int_equal(proto_fields_within(4, WHOLE, PARTS), 4);
    assert_int_equal(proto_fields_within(OTHER, WHOLE, PARTS), 0);
}

static void refuses_repeated_parameters(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("from", "v:1", "to", "v:2", "from", "v:3");
    assert_false(proto_parameters_check(&parameters, names, &problem));
    assert_parameter(&problem, "from");
    parameters = NO_QUERY;
    assert_true(proto_parameters_check(&parameters, NULL, &problem));
    parameters = QUERY("to", "v:2");
    assert_true(proto_parameters_check(&parameters, names, &problem));
    assert_false(proto_parameters_check(&parameters, NULL, &problem));
    assert_parameter(&problem, "to");
}

static void requires_values(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("from", "", "to", "v:2");
    assert_string_equal(proto_parameters_require(&parameters, "to", &problem), "v:2");
    assert_null(proto_parameters_require(&parameters, "from", &problem));
    assert_parameter(&problem, "from");
    assert_null(proto_parameters_require(&parameters, "point", &problem));
    assert_parameter(&problem, "point");
}

static void absent_parameters_change_nothing(void **state)
{
    (void)state;
    static const char *const words[] = {"a", "b", NULL};
    struct proto_problem problem;
    struct proto_parameters parameters = NO_QUERY;
    uint64_t integer = 7;
    unsigned word = 7;
    assert_true(proto_parameters_integer(&parameters, "n", 1, 9, &integer, &problem));
    assert_true(proto_parameters_choice(&parameters, "w", words, &word, &problem));
    assert_true(integer == 7 && word == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_options),
        cmocka_unit_test(refuses_bad_values),
        cmocka_unit_test(operations_without_fields_refuse_select),
        cmocka_unit_test(errors_list_the_choices),
        cmocka_unit_test(the_progress_of_the_whole_covers_all_parts),
        cmocka_unit_test(refuses_repeated_parameters),
        cmocka_unit_test(requires_values),
        cmocka_unit_test(absent_parameters_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
