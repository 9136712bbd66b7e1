/* Compares the kernels that find the shortest decimal digits of doubles. A kernel with SIMD lanes
 * must find the digits that the plain kernel finds. The SIMD kernel may skip rare values, which
 * gd__decimals_set converts. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/decimals.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static gd__decimals_kernel *kernels[2];
static unsigned kernel_count;

static void find_kernels(void)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) kernels[kernel_count++] = gd__decimals_avx2;
#endif
    if (!kernel_count) print_message("this machine has no lanes: there is nothing to compare\n");
}

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state * UINT64_C(0x2545f4914f6cdd1d);
}

/* Returns a random number. `turn` selects its kind: any bit pattern; an exponent in or near the
 * range of the lanes; such an exponent with few significant bits; a decimal of few digits; such a
 * decimal moved by some units in the last place; a multiple of 0.001. */
static double random_double(uint64_t *state, long turn)
{
    uint64_t bits = next_random(state), few = ~((UINT64_C(1) << next_random(state) % 53) - 1);
    uint64_t near = (bits & UINT64_C(0x800fffffffffffff)) | (1000 + next_random(state) % 84) << 52;
    double value =
        (double)(bits % 100000000) / (double[]){1, 1e2, 1e4, 1e8, 1e12}[next_random(state) % 5];
    if (turn % 6 == 3) return value;
    if (turn % 6 == 4) return value * (1 + (double)(next_random(state) % 9) * 0x1p-52);
    if (turn % 6 == 5) return (double)(bits >> 11) / 1000;
    bits = turn % 6 == 0 ? bits : turn % 6 == 1 ? near : near & few;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Asserts that both kernels find the same digits of each value that `kernel` does not skip. Returns
 * the number of values that `kernel` skips although the plain kernel finds their digits. */
static uint32_t assert_agreement(gd__decimals_kernel *kernel, const double *values, uint32_t count)
{
    struct gd__decimals plain, found;
    memset(&plain, 1, sizeof plain);
    memset(&found, 2, sizeof found);
    uint32_t all = (1u << count) - 1, rare = gd__decimals_plain(values, count, &plain) & all,
             left_out = kernel(values, count, &found) & all;
    assert_int_equal(rare & ~left_out, 0);
    for (uint32_t i = 0; i < count; i++) {
        if (left_out >> i & 1) continue;
        if (plain.head[i] != found.head[i] || plain.counting[i] != found.counting[i] ||
            memcmp(plain.digits[i], found.digits[i], sizeof plain.digits[i]) != 0)
            fail_msg("%a is %c%.16s, point and sign %#jx, not %c%.16s, %#jx", values[i],
                     (char)plain.head[i], plain.digits[i], (uintmax_t)plain.head[i] >> 8,
                     (char)found.head[i], found.digits[i], (uintmax_t)found.head[i] >> 8);
    }
    return left_out & ~rare;
}

/* GD_NUMBER_RUNS: how many numbers to test, for example 10000000. */
static void lanes_agree_with_plain_code(void **state)
{
    (void)state;
    const char *runs = getenv("GD_NUMBER_RUNS");
    double values[GD__DECIMALS];
    uint64_t seed = 88172645463325252u;
    for (long turn = 0, end = runs ? atol(runs) / GD__DECIMALS : 20000; turn < end; turn++) {
        uint32_t count = 1 + (uint32_t)(next_random(&seed) % GD__DECIMALS);
        for (uint32_t i = 0; i < count; i++) values[i] = random_double(&seed, turn);
        for (unsigned k = 0; k < kernel_count; k++) assert_agreement(kernels[k], values, count);
    }
}

/* A skipped value costs time but is still converted correctly. Of random numbers whose bits are all
 * significant, the SIMD lanes skip one in 30 million, because it is too close to a tie. */
static void lanes_leave_out_few_values(void **state)
{
    (void)state;
    enum { RUNS = 20000 };
    double values[GD__DECIMALS];
    uint64_t seed = 1;
    for (unsigned k = 0; k < kernel_count; k++) {
        unsigned left_out = 0;
        for (int run = 0; run < RUNS; run++) {
            for (int i = 0; i < GD__DECIMALS; i++)
                values[i] = (double)(int64_t)next_random(&seed) * 0x1p-60;
            left_out +=
                (unsigned)__builtin_popcount(assert_agreement(kernels[k], values, GD__DECIMALS));
        }
        assert_in_range(left_out, 0, 3);
    }
}

static uint32_t left_out_of(gd__decimals_kernel *kernel, double value)
{
    struct gd__decimals found;
    return kernel(&value, 1, &found) & 1;
}

static void special_values_are_left_out(void **state)
{
    (void)state;
    static const double values[] = {
        0, -0.0, INFINITY, -INFINITY, NAN, 1e-7, -9.9999999999999974e-7, 1e17, 1e300, 5e-324};
    for (size_t i = 0; i < COUNT(values); i++) {
        assert_int_equal(left_out_of(gd__decimals_plain, values[i]), 1);
        for (unsigned k = 0; k < kernel_count; k++)
            assert_int_equal(left_out_of(kernels[k], values[i]), 1);
    }
    assert_int_equal(left_out_of(gd__decimals_plain, 1e-6), 0);
    assert_int_equal(left_out_of(gd__decimals_plain, 99999999999999984.0), 0);
}

/* Tests each power of two that the lanes handle (its rounding interval is asymmetric), half-way
 * cases such as 2251799813685248.5, and the neighbours of these numbers. */
static void lanes_agree_about_rare_numbers(void **state)
{
    (void)state;
    double values[3];
    for (int e = -40; e < 80; e++) {
        for (int odd = 1; odd < 200; odd += 2) {
            values[0] = ldexp(odd, e);
            values[1] = nextafter(values[0], 0);
            values[2] = nextafter(values[0], INFINITY);
            for (unsigned k = 0; k < kernel_count; k++) assert_agreement(kernels[k], values, 3);
        }
    }
    for (int64_t n = INT64_C(1) << 51; n < (INT64_C(1) << 51) + 2000; n++) {
        values[0] = (double)n + 0.5;
        values[1] = ((double)n + 0.5) / 4;
        values[2] = ((double)n + 0.5) * 8;
        for (unsigned k = 0; k < kernel_count; k++) assert_agreement(kernels[k], values, 3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lanes_agree_with_plain_code),
        cmocka_unit_test(lanes_leave_out_few_values),
        cmocka_unit_test(special_values_are_left_out),
        cmocka_unit_test(lanes_agree_about_rare_numbers),
    };
    find_kernels();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
