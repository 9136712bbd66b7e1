#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "gd/colour_map.h"

static double light(struct gd_colour c)
{
    return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
}

/* The lightness shows the order to viewers who do not distinguish hues. */
static void grows_lighter(void **state)
{
    (void)state;
    for (int i = 0; i < 256; i++)
        assert_true(light(gd_colour_map(i / 256.0)) < light(gd_colour_map((i + 1) / 256.0)));
}

/* A clamped component would make the steps of the map uneven. */
static void stays_within_its_gamut(void **state)
{
    (void)state;
    for (int i = 0; i <= 256; i++) {
        struct gd_colour c = gd_colour_map(i / 256.0);
        assert_true(c.red > 0 && c.red < 1 && c.green > 0 && c.green < 1 && c.blue > 0 &&
                    c.blue < 1);
    }
    assert_true(light(gd_colour_map(-3)) == light(gd_colour_map(0)) &&
                light(gd_colour_map(3)) == light(gd_colour_map(1)));
}

static void encodes_as_srgb(void **state)
{
    (void)state;
    assert_true(gd_colour_encode(-1) == 0 && gd_colour_encode(0) == 0);
    assert_true(fabs(gd_colour_encode(1) - 1) < 1e-15 && fabs(gd_colour_encode(2) - 1) < 1e-15);
    assert_true(fabs(gd_colour_encode(0.0031308) - 0.04044994) < 1e-7);
    assert_true(fabs(gd_colour_encode(0.21404114) - 0.5) < 1e-7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grows_lighter),
        cmocka_unit_test(stays_within_its_gamut),
        cmocka_unit_test(encodes_as_srgb),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
