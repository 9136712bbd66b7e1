#include "tests/support/test.h"

#include <string.h>

#include "gd/cpu.h"
#include "kernel/kernel.h"

static void refuses_unknown_names(void **state)
{
    (void)state;
    static const char *const names[] = {"",        "sse2", "AVX2",      "avx",  "avx2 ",
                                        "avx5122", "base", "automatic", "plain"};
    check_ok(gd_cpu_select("baseline"), NULL);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(gd_cpu_select(names[i]), GD_INVALID_ARGUMENT);
        assert_string_equal(gd_cpu_name(), "baseline");
    }
    check_ok(gd_cpu_select("auto"), NULL);
}

/* A supported instruction set is selected. Any other name returns an error and keeps the
 * selection. */
static void selects_supported_sets(void **state)
{
    (void)state;
    check_ok(gd_cpu_select("baseline"), NULL);
    assert_string_equal(gd_cpu_name(), "baseline");
#if defined(__x86_64__)
    const struct {
        const char *name;
        bool has;
    } sets[] = {{"avx2", __builtin_cpu_supports("avx2")},
                {"avx512", __builtin_cpu_supports("avx512f") &&
                               __builtin_cpu_supports("avx512vl") &&
                               __builtin_cpu_supports("avx512dq")}};
    for (int i = 0; i < 2; i++) {
        check_ok(gd_cpu_select("baseline"), NULL);
        assert_int_equal(gd_cpu_select(sets[i].name), sets[i].has ? GD_OK : GD_UNSUPPORTED);
        assert_string_equal(gd_cpu_name(), sets[i].has ? sets[i].name : "baseline");
        print_message("# %s: %s\n", sets[i].name,
                      sets[i].has ? "supported" : "not on this machine");
    }
#else
    /* instruction sets of other machines */
    assert_int_equal(gd_cpu_select("avx2"), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_cpu_select("avx512"), GD_INVALID_ARGUMENT);
#endif
}

static void auto_selects_the_widest(void **state)
{
    (void)state;
    const char *widest = "baseline";
    if (gd_cpu_select("avx2") == GD_OK) widest = "avx2";
    if (gd_cpu_select("avx512") == GD_OK) widest = "avx512";
    check_ok(gd_cpu_select("baseline"), NULL);
    check_ok(gd_cpu_select("auto"), NULL);
    assert_string_equal(gd_cpu_name(), widest);
    assert_string_equal(gd__kernel_in_use()->name, widest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_unknown_names),
        cmocka_unit_test(selects_supported_sets),
        cmocka_unit_test(auto_selects_the_widest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
