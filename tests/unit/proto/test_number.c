#include "support.h"

#include <math.h>
#include <stdio.h>

#include "proto/json/number.h"

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void prints_integers(void **state)
{
    (void)state;
    static const uint64_t values[] = {
        0, 7, 10, 99, 100, 101, 4294967295u, 999999999999u, UINT64_MAX - 1, UINT64_MAX};
    for (size_t i = 0; i < COUNT(values); i++) {
        char text[PROTO_INTEGER_SIZE + 1], expected[32];
        text[proto_integer_print(values[i], text)] = '\0';
        snprintf(expected, sizeof expected, "%llu", (unsigned long long)values[i]);
        assert_string_equal(text, expected);
    }
}

static void reads_json_numbers_only(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t length;
        double value;
    } cases[] = {
        {"0", 1, 0},
        {"-0", 2, -0.0},
        {"12,", 2, 12},
        {"1.50:", 4, 1.5},
        {"1e3", 3, 1000},
        {"1E-2,", 4, 0.01},
        {"-2.5e+1", 7, -25},
        {"1e-400", 6, 0},
        {"0.1000000000000000055511151231257827021181583404541015625", 57, 0.1},
        {"0x10", 0, 0},
        {"-0X1", 0, 0},
        {"", 0, 0},
        {"-", 0, 0},
        {"+1", 0, 0},
        {" 1", 0, 0},
        {".5", 0, 0},
        {"5.", 0, 0},
        {"01", 0, 0},
        {"1e", 0, 0},
        {"1e+", 0, 0},
        {"nan", 0, 0},
        {"inf", 0, 0},
        {"-infinity", 0, 0},
        {"1e999", 0, 0},
        {"-1e309", 0, 0},
        {"1.e5", 0, 0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        double value = 77;
        assert_int_equal(proto_number_parse(cases[i].text, &value), cases[i].length);
        assert_true(bits_of(value) == bits_of(cases[i].length ? cases[i].value : 77));
    }
}

static void reads_integers(void **state)
{
    (void)state;
    uint64_t value = 77;
    assert_int_equal(proto_integer_parse("18446744073709551615x", &value), 20);
    assert_true(value == UINT64_MAX);
    assert_int_equal(proto_integer_parse("0", &value), 1);
    assert_int_equal(value, 0);
    static const char *const bad[] = {
        "", "x", "-1", "+1", " 1", "00", "012", "18446744073709551616", "99999999999999999999999"};
    for (size_t i = 0; i < COUNT(bad); i++)
        assert_int_equal(proto_integer_parse(bad[i], &value), 0);
    assert_int_equal(value, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(prints_integers),
        cmocka_unit_test(reads_json_numbers_only),
        cmocka_unit_test(reads_integers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
