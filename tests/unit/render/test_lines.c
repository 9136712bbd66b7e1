#include "tests/support/test.h"

#include "render/lines.h"

static double length_of(const struct gd__lines *lines)
{
    double length = 0;
    for (uint32_t i = 0; i < lines->count; i++)
        for (uint32_t k = gd__line_begin(lines, i); k + 1 < lines->ends[i]; k++)
            length += hypot((double)lines->places[k + 1].x - lines->places[k].x,
                            (double)lines->places[k + 1].y - lines->places[k].y);
    return length;
}

/* Adds a spiral of `count` points. */
static void spiral(struct gd__lines *lines, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        double angle = 0.02 * i, radius = 5 + 3 * angle;
        gd__lines_add(lines, 200 + radius * cos(angle), 200 + radius * sin(angle));
    }
    gd__lines_end(lines);
}

static double distance_to(const struct gd__lines *lines, struct gd__pixel_point p)
{
    double least = INFINITY;
    for (uint32_t k = 0; k + 1 < lines->ends[0]; k++) {
        struct gd__pixel_point a = lines->places[k], b = lines->places[k + 1];
        double x = (double)b.x - a.x, y = (double)b.y - a.y,
               t = ((p.x - a.x) * x + (p.y - a.y) * y) / (x * x + y * y);
        t = fmin(fmax(t, 0), 1);
        least = fmin(least, hypot(p.x - a.x - t * x, p.y - a.y - t * y));
    }
    return least;
}

static void fewer_places_same_line(void **state)
{
    (void)state;
    struct gd__lines all = {0}, few = {0};
    spiral(&all, 1000);
    spiral(&few, 1000);
    gd__lines_simplify(&few, 0.1);
    assert_true(few.place_count < 300);
    for (uint32_t i = 0; i < all.place_count; i++)
        assert_true(distance_to(&few, all.places[i]) <= 0.1 + 1e-4);
    assert_memory_equal(&few.places[0], &all.places[0], sizeof few.places[0]);
    assert_memory_equal(&few.places[few.place_count - 1], &all.places[999], sizeof few.places[0]);
    gd__lines_free(&all);
    gd__lines_free(&few);
}

static void short_lines_stay(void **state)
{
    (void)state;
    for (uint32_t count = 1; count < 4; count++) {
        struct gd__lines lines = {0};
        for (uint32_t i = 0; i < count; i++) gd__lines_add(&lines, 10 * i, i % 2);
        gd__lines_end(&lines);
        gd__lines_simplify(&lines, 0.1);
        assert_int_equal(lines.count, 1);
        assert_int_equal(lines.place_count, count);
        gd__lines_free(&lines);
    }
}

static void dashes_have_their_lengths(void **state)
{
    (void)state;
    struct gd__lines line = {0}, dashes = {0};
    gd__lines_add(&line, 0, 0);
    gd__lines_add(&line, 33, 44); /* the line has the length 55, and its bend is within a dash */
    gd__lines_add(&line, 33, 49);
    gd__lines_end(&line);
    gd__lines_dash(&line, 4, 6, &dashes);
    assert_int_equal(dashes.count, 6); /* dashes begin at 0, 10, 20, 30, 40, 50 */
    check_close(length_of(&dashes), 24, 1e-5);
    gd__lines_free(&line);
    gd__lines_free(&dashes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(fewer_places_same_line),
                                       cmocka_unit_test(short_lines_stay),
                                       cmocka_unit_test(dashes_have_their_lengths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
