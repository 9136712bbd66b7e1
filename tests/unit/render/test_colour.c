#include "tests/support/test.h"

#include "render/colour.h"

struct oklab {
    double lightness, a, b;
};

static double linear_of(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

static struct oklab oklab_of(struct gd__colour colour)
{
    double r = linear_of(colour.red), g = linear_of(colour.green), b = linear_of(colour.blue);
    double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b),
           m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b),
           s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return (struct oklab){0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
                          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
                          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

/* Converts from sRGB to Oklab and checks that steps are even. Clamped colour components would make
 * the steps uneven. */
static void equal_steps_look_equal(void **state)
{
    (void)state;
    enum { STEPS = 100 };
    double first = 0, worst = 0;
    for (int i = 0; i < STEPS; i++) {
        struct oklab p = oklab_of(gd__colour_of_part((double)i / STEPS)),
                     q = oklab_of(gd__colour_of_part((i + 1.0) / STEPS));
        double step = hypot(hypot(q.lightness - p.lightness, q.a - p.a), q.b - p.b);
        assert_true(q.lightness > p.lightness + 0.4 / STEPS);
        if (i == 0) first = step;
        worst = fmax(worst, fabs(step / first - 1));
    }
    print_message("# steps of distance differ to the eye by %.1f %% at most\n", 100 * worst);
    assert_true(worst < 0.02);
}

/* Luminance, which remains in black-and-white print and for colour-blind readers, grows with the
 * distance. */
static void order_survives_without_hues(void **state)
{
    (void)state;
    double before = -1;
    for (int i = 0; i <= 64; i++) {
        struct gd__colour c = gd__colour_of_part(i / 64.0);
        double luminance =
            0.2126 * linear_of(c.red) + 0.7152 * linear_of(c.green) + 0.0722 * linear_of(c.blue);
        assert_true(luminance > before);
        before = luminance;
    }
}

static void beyond_the_ends_are_the_ends(void **state)
{
    (void)state;
    struct gd__colour first = gd__colour_of_part(0), last = gd__colour_of_part(1),
                      below = gd__colour_of_part(-3), above = gd__colour_of_part(7);
    assert_memory_equal(&first, &below, sizeof first);
    assert_memory_equal(&last, &above, sizeof last);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(equal_steps_look_equal),
                                       cmocka_unit_test(order_survives_without_hues),
                                       cmocka_unit_test(beyond_the_ends_are_the_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
