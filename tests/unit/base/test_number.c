#include "tests/support/test.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/number.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void check_parse(const char *text, double expected, size_t length)
{
    double value = 77;
    const char *end = gd_number_parse(text, text + strlen(text), &value);
    if (!end || (size_t)(end - text) != length)
        fail_msg("'%s' should end after %zu bytes", text, length);
    if (bits_of(value) != bits_of(expected))
        fail_msg("'%s' is read as %.17g, not %.17g", text, value, expected);
}

static void parses_correctly_rounded(void **state)
{
    (void)state;
    static const char *const texts[] = {"0",
                                        "-0",
                                        "1",
                                        "16777217",
                                        "0.1",
                                        "1e-320",
                                        "4.9406564584124654e-324",
                                        "2.4703282292062328e-324",
                                        "1.7976931348623157e308",
                                        "1.7976931348623158e308",
                                        "123456789012345678901234567890",
                                        "9007199254740993",
                                        "9007199254740992.99999999999999999999999999999999999",
                                        "9007199254740993.00000000000000000000000000000000001",
                                        "2.2250738585072011e-308",
                                        "2.2250738585072014e-308",
                                        "6.631236846766476e-316",
                                        "8.5e22",
                                        "1e23",
                                        ".5",
                                        "5.",
                                        "00012",
                                        "-3.5E+10",
                                        "1e-5",
                                        "0e999999999999999999999",
                                        "0.000e-99999999999"};
    for (size_t i = 0; i < COUNT(texts); i++)
        check_parse(texts[i], strtod(texts[i], NULL), strlen(texts[i]));
}

static void parses_numbers_out_of_range(void **state)
{
    (void)state;
    check_parse("1e309", INFINITY, 5);
    check_parse("-1.8e308", -INFINITY, 8);
    check_parse("1e99999999999999999999", INFINITY, 22);
    check_parse("1e-400", 0, 6);
    check_parse("-1e-400", -0.0, 7);
    check_parse("2e-324", 0, 6);
    check_parse("1e-99999999999999999999", 0, 23);
    check_parse("+1e+309", INFINITY, 7);

    static char text[1000];
    memset(text, '0', sizeof text - 1); /* 0.00...01 */
    text[1] = '.';
    text[sizeof text - 2] = '1';
    check_parse(text, 0, sizeof text - 1);
    memset(text, '1', sizeof text - 1); /* 11...1 */
    check_parse(text, INFINITY, sizeof text - 1);
    memcpy(text + sizeof text - 6, "e-994", 6); /* 11...1e-994: back in range */
    check_parse(text, strtod(text, NULL), sizeof text - 1);
}

static void stops_where_the_number_ends(void **state)
{
    (void)state;
    check_parse("1x", 1, 1);
    check_parse("1.5.2", 1.5, 3);
    check_parse("1e", 1, 1);
    check_parse("1e+", 1, 1);
    check_parse("0x1p3", 0, 1);
    check_parse("+2", 2, 2);
    double value = 77;
    static const char *const none[] = {"",    "+",   "-",   ".",  "e5",   "x",  "+-1",
                                       "-+1", "++1", "--1", " 1", "+inf", "+ 1"};
    for (size_t i = 0; i < COUNT(none); i++) {
        if (gd_number_parse(none[i], none[i] + strlen(none[i]), &value))
            fail_msg("'%s' is not a number", none[i]);
    }
    const char *text = "12345";
    assert_ptr_equal(gd_number_parse(text, text + 3, &value), text + 3);
    assert_true(value == 123);
}

static const char *printed(double value)
{
    static char text[GD_NUMBER_SIZE + 1];
    char *end = gd_number_format(text, value);
    assert_in_range(end - text, 1, GD_NUMBER_SIZE);
    *end = '\0';
    return text;
}

static void prints_without_needless_exponents(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {
        {0, "0"},
        {-0.0, "-0"},
        {1, "1"},
        {-1.5, "-1.5"},
        {100, "100"},
        {0.1, "0.1"},
        {1.0 / 3, "0.3333333333333333"},
        {123.456, "123.456"},
        {0.000001, "0.000001"},
        {9.5e-7, "9.5e-7"},
        {1e-7, "1e-7"},
        {1e16, "10000000000000000"},
        {12345678901234568, "12345678901234568"},
        {1e17, "1e17"},
        {1.5e300, "1.5e300"},
        {1e23, "1e23"},
        {9007199254740991, "9007199254740991"},
        {9007199254740993.0, "9007199254740992"},
        {DBL_MAX, "1.7976931348623157e308"},
        {DBL_MIN, "2.2250738585072014e-308"},
        {5e-324, "5e-324"},
        {-2.2250738585072009e-308, "-2.225073858507201e-308"},
        {2.9802322387695312e-8, "2.9802322387695312e-8"},
        {5e-324 * 3, "1.5e-323"},
        {2251799813685248.5, "2251799813685248.5"},
        {0x1p-1022 - 0x1p-1074, "2.225073858507201e-308"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_string_equal(printed(cases[i].value), cases[i].text);
}

/* Copies the digits of a decimal text. Omits sign, point, exponent, leading zeros and trailing
 * zeros. */
static size_t digits_of(const char *text, char *out)
{
    size_t count = 0;
    for (; *text && *text != 'e'; text++) {
        if (*text >= '0' && *text <= '9' && (count > 0 || *text != '0')) out[count++] = *text;
    }
    while (count > 0 && out[count - 1] == '0') count--;
    out[count] = '\0';
    return count;
}

/* Writes the fewest digits from which strtod reads `value` again. The C library rounds `value` to
 * these digits. Returns their number. */
static size_t reference_digits(double value, char *out)
{
    char text[40];
    for (int digits = 1;; digits++) {
        snprintf(text, sizeof text, "%.*e", digits - 1, value);
        if (digits == 17 || strtod(text, NULL) == value) return digits_of(text, out);
    }
}

/* Checks that the text reads back as `value` and has the reference's digits. Doubles lie closer
 * together below a power of two than above it. At a power of two, a shorter decimal than the
 * reference may therefore exist, because the reference tries only the nearest decimal of each
 * length. */
static void assert_shortest(double value)
{
    char digits[40], reference[40];
    const char *text = printed(value);
    check_parse(text, value, strlen(text));
    assert_true(bits_of(strtod(text, NULL)) == bits_of(value));
    size_t count = digits_of(text, digits), fewest = reference_digits(value, reference);
    bool power_of_two = (bits_of(value) & ((UINT64_C(1) << 52) - 1)) == 0;
    assert_true(count == fewest || (power_of_two && count < fewest));
    if (count == fewest && !power_of_two) assert_string_equal(digits, reference);
}

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state * UINT64_C(0x2545f4914f6cdd1d);
}

/* Returns a random number. `turn` selects its kind: any bit pattern; few significant bits; a number
 * in [0, 1); a decimal of few digits. */
static double random_double(uint64_t *state, long turn)
{
    uint64_t bits = next_random(state);
    double value;
    if (turn % 4 == 1) bits &= ~((UINT64_C(1) << next_random(state) % 53) - 1);
    if (turn % 4 == 2) return (double)(bits >> 11) * 0x1p-53;
    if (turn % 4 == 3) return (double)(bits % 1000000) / 1000;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* GD_NUMBER_RUNS: how many numbers to test, for example 10000000. */
static void prints_shortest(void **state)
{
    (void)state;
    const char *runs = getenv("GD_NUMBER_RUNS");
    uint64_t seed = 88172645463325252u;
    for (long turn = 0, end = runs ? atol(runs) : 200000; turn < end; turn++) {
        double value = random_double(&seed, turn);
        if (isfinite(value) && value != 0) assert_shortest(value);
    }
}

static void prints_every_power_shortest(void **state)
{
    (void)state;
    for (int e = -1074; e < 1024; e++) {
        double value = ldexp(1, e);
        assert_shortest(value);
        assert_shortest(nextafter(value, INFINITY));
        if (e > -1074) assert_shortest(nextafter(value, 0));
    }
    for (int e = -323; e <= 308; e++) {
        char text[16];
        snprintf(text, sizeof text, "1e%d", e);
        assert_shortest(strtod(text, NULL));
    }
}

/* Writes what gd_numbers_format must write, one number at a time. */
static size_t print_each(const double *values, size_t count, char *out)
{
    char *at = out;
    for (size_t i = 0; i < count; i++)
        at += sprintf(at, "%s,", isfinite(values[i]) ? printed(values[i]) : "null");
    return (size_t)(at - out);
}

static size_t print_each_triple(const double (*values)[3], size_t count, char *out)
{
    char *at = out;
    for (size_t i = 0; i < count; i++) {
        *at++ = '[';
        at += print_each(values[i], 3, at);
        at[-1] = ']';
        *at++ = ',';
    }
    return (size_t)(at - out);
}

/* Allocates exactly the promised size, so that AddressSanitizer detects a write beyond it. */
static void assert_written_alike(const double (*values)[3], size_t count)
{
    static char expected[GD_TRIPLES_SIZE(100)];
    char *text = malloc(GD_NUMBERS_SIZE(3 * count)),
         *end = gd_numbers_format(text, *values, 3 * count);
    assert_int_equal(end - text, print_each(*values, 3 * count, expected));
    assert_memory_equal(text, expected, (size_t)(end - text));
    free(text);
    text = malloc(GD_TRIPLES_SIZE(count));
    end = gd_triples_format(text, values, count);
    assert_int_equal(end - text, print_each_triple(values, count, expected));
    assert_memory_equal(text, expected, (size_t)(end - text));
    free(text);
}

static void arrays_print_as_single_numbers(void **state)
{
    (void)state;
    static const double rare[] = {
        0, -0.0, NAN, INFINITY, -INFINITY, 1, -0.5, 1e-7, 1e17, 123456, -2.2250738585072014e-308};
    uint64_t seed = 88172645463325252u;
    double values[100][3];
    for (long turn = 0; turn < 2000; turn++) {
        size_t count = next_random(&seed) % COUNT(values) + 1;
        for (size_t i = 0; i < 3 * count; i++) {
            bool is_rare = turn % 2 && next_random(&seed) % 16 == 0;
            values[i / 3][i % 3] = is_rare ? rare[next_random(&seed) % COUNT(rare)]
                                           : random_double(&seed, turn + (long)i);
        }
        assert_written_alike(values, count);
    }
    for (size_t i = 0; i < 100; i++)
        values[i][0] = values[i][1] = values[i][2] = -2.2250738585072014e-308;
    assert_written_alike(values, 100);
    assert_written_alike(values, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parses_correctly_rounded),
        cmocka_unit_test(parses_numbers_out_of_range),
        cmocka_unit_test(stops_where_the_number_ends),
        cmocka_unit_test(prints_without_needless_exponents),
        cmocka_unit_test(prints_shortest),
        cmocka_unit_test(prints_every_power_shortest),
        cmocka_unit_test(arrays_print_as_single_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
