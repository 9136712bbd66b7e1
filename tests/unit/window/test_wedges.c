/* Tests that the general writer of wedges stores windows, gaps and ends, and that they are read
 * back. */
#include "tests/unit/window/model.h"

#include <stdlib.h>

#include "gd/polygons.h"
#include "window/wedges.h"

enum { MOST = 12 };

/* The wedges of a list, with room for them. */
struct written {
    struct gd__wedges wedges;
    uint32_t count;
    union {
        struct gd__chunk chunk;
        uint64_t room[2 + 3 * (2 * MOST + 1)];
    };
};

static struct gd__window_builder builder;

static int free_builder(void **state)
{
    (void)state;
    gd__window_builder_destroy(&builder);
    return 0;
}

/* Writes the wedges in the given form, if the sources' numbers fit into this form. */
static void write_as(const struct gd__stack *list, double length, bool mirrored,
                     enum gd__wedge_form form, struct written *out)
{
    build_windows(list, &builder);
    out->chunk = (struct gd__chunk){.form = form};
    gd__chunk_write(&builder.at, list->count, length, mirrored, &out->chunk);
    gd__chunk_link(&out->chunk, list->count % 2 ? 17 : GD_NONE);
    out->count = out->chunk.count;
    assert_int_equal(gd__chunk_previous(&out->chunk), list->count % 2 ? 17 : GD_NONE);
    assert_true(out->count <= gd__wedges_bound(list->count));
    assert_true(gd__chunk_bytes(&out->chunk) <= gd__chunk_bound(list->count));
    out->wedges = gd__chunk_wedges(&out->chunk);
}

static void write(const struct gd__stack *list, double length, bool mirrored, struct written *out)
{
    write_as(list, length, mirrored, GD__WEDGE_20, out);
    assert_int_equal(out->chunk.form, GD__WEDGE_20);
}

static double x_of(const struct written *w, uint32_t i)
{
    return gd__wedge_x(&w->wedges, i);
}

static double y_of(const struct written *w, uint32_t i)
{
    return gd__wedge_y(&w->wedges, i);
}

static void check_wedge(const struct written *written, uint32_t i, double length, double b0,
                        double b1, uint32_t source)
{
    struct gd__window w = gd__wedge_window(&written->wedges, i, length);
    assert_true(fabs(w.b0 - b0) <= length * GD__WEDGE_UNIT &&
                fabs(w.b1 - b1) <= length * GD__WEDGE_UNIT);
    assert_int_equal(w.source, source);
}

static void marks_gaps_before_between_and_behind(void **state)
{
    (void)state;
    struct gd__window windows[2] = {{.b0 = 1, .b1 = 2, .x = 1, .y = 3, .sigma = 9, .source = 7},
                                    {.b0 = 3, .b1 = 3.5, .x = 2, .y = 1, .sigma = 9, .source = 8}};
    struct gd__stack list = {windows, 2, 2};
    struct written w;
    write(&list, 4, false, &w);
    assert_int_equal(w.count, 5);
    check_wedge(&w, 0, 4, 0, 1, GD_NONE);
    check_wedge(&w, 1, 4, 1, 2, 7);
    check_wedge(&w, 2, 4, 2, 3, GD_NONE);
    check_wedge(&w, 3, 4, 3, 3.5, 8);
    check_wedge(&w, 4, 4, 3.5, 4, GD_NONE);
    write(&list, 4, true, &w); /* writes for the other side of the edge */
    assert_int_equal(w.count, 5);
    check_wedge(&w, 0, 4, 0, 0.5, GD_NONE);
    check_wedge(&w, 1, 4, 0.5, 1, 8);
    check_wedge(&w, 2, 4, 1, 2, GD_NONE);
    check_wedge(&w, 3, 4, 2, 3, 7);
    check_wedge(&w, 4, 4, 3, 4, GD_NONE);
    assert_true(x_of(&w, 1) == 2 && y_of(&w, 1) == 1 && x_of(&w, 3) == 3 && y_of(&w, 3) == 3);
}

/* Gaps of the size of rounding are closed. The first window begins at the edge's end. */
static void closes_gaps_of_the_size_of_rounding(void **state)
{
    (void)state;
    double d = 0.1 * GD_TOL_ADJACENT;
    struct gd__window windows[2] = {{.b0 = d, .b1 = 0.5, .y = 1, .sigma = 3, .source = 1},
                                    {.b0 = 0.5 + d, .b1 = 1 - d, .y = 1, .sigma = 3, .source = 2}};
    struct gd__stack list = {windows, 2, 2};
    struct written w;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        write(&list, 1, mirrored, &w);
        assert_int_equal(w.count, 2);
        assert_int_equal(w.wedges.start[0], 0);
        check_wedge(&w, mirrored ? 1 : 0, 1, mirrored ? 0.5 : 0, mirrored ? 1 : 0.5, 1);
    }
}

/* A chunk stores the side of its sources, also where y is zero. */
static void the_chunk_stores_the_side(void **state)
{
    (void)state;
    struct gd__window window = {.b0 = 0, .b1 = 1, .x = 0.25, .y = 0, .source = 3};
    struct gd__stack list = {&window, 1, 1};
    struct written w;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        write_as(&list, 1, mirrored, GD__WEDGE_20, &w);
        assert_int_equal(w.chunk.form, GD__WEDGE_WIDE);
        struct gd__window read = gd__wedge_window(&w.wedges, 0, 1);
        assert_int_equal(read.tags, mirrored ? GD__WINDOW_FAR_SIDE : 0);
        assert_true(read.x == (mirrored ? 0.75 : 0.25) && read.y == 0 && !signbit(read.y));
    }
}

/* Returns the largest error of a coordinate. */
static double coordinate_error(const struct written *w)
{
    if (w->wedges.form == GD__WEDGE_WIDE) return 0;
    return gd__wedge_least(w->wedges.exponent);
}

/* Random lists are read back up to 2^-32 of the edge, in the frame of side 0. */
static void reads_back_what_was_written(void **state)
{
    (void)state;
    struct rng rng = {9};
    struct gd__stack list = {0};
    for (int round = 0; round < 20000; round++) {
        double length = exp(rng_between(&rng, -3, 3)), at = 0;
        bool mirrored = round % 2;
        uint32_t count = 1 + rng_below(&rng, MOST), next = 0;
        list.count = 0;
        for (uint32_t i = 0; i < count; i++) {
            struct gd__window w = random_window(&rng, i);
            w.sigma += round % 5 * length;
            w.b0 = at += rng_unit(&rng) < 0.5 ? 0 : 0.3 * length / MOST;
            w.b1 = at = i + 1 == count && round % 3
                            ? length
                            : at + rng_between(&rng, 0.01, 0.7) * length / MOST;
            append_window(&list, w);
        }
        struct written w;
        write_as(&list, length, mirrored, round % 3, &w);
        for (uint32_t i = 0; i < w.count; i++) {
            struct gd__window read = gd__wedge_window(&w.wedges, i, length);
            if (i) assert_true(w.wedges.start[i] >= w.wedges.start[i - 1]);
            if (read.source == GD_NONE) {
                assert_true(x_of(&w, i) == 0 && y_of(&w, i) == 0);
                continue;
            }
            struct gd__window expected = list.windows[mirrored ? count - 1 - next : next];
            if (mirrored) expected = gd__window_mirrored(&expected, length);
            double error = coordinate_error(&w);
            assert_true(fabs(read.x - expected.x) <= error && fabs(read.y - expected.y) <= error &&
                        read.source == expected.source);
            assert_int_equal(read.tags, mirrored ? GD__WINDOW_FAR_SIDE : 0);
            check_wedge(&w, i, length, expected.b0, expected.b1, expected.source);
            next++;
        }
        assert_int_equal(next, count);
        assert_int_equal(w.wedges.start[0], 0);
    }
    gd__stack_destroy(&list);
}

/* Linear windows are read back on both sides of the edge. Their ends are rounded inwards. */
static void linear_windows_come_back(void **state)
{
    (void)state;
    double length = 2.5;
    for (int degree = 1; degree < 180; degree++) {
        double angle = degree * M_PI / 180, b0[9] = {0.3}, b1[9] = {1.7}, x[9] = {cos(angle)},
               y[9] = {sin(angle)}, sigma[9] = {-0.25};
        uint32_t source[9] = {GD__SOURCE_LINEAR | 77};
        struct gd__windows windows = {b0, b1, x, y, sigma, source};
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            struct written written;
            written.chunk = (struct gd__chunk){.form = GD__WEDGE_20};
            gd__chunk_write(&windows, 1, length, mirrored, &written.chunk);
            assert_true(written.chunk.count == 3 && written.chunk.form == GD__WEDGE_WIDE);
            struct gd__wedges wedges = gd__chunk_wedges(&written.chunk);
            struct gd__window w = gd__wedge_window(&wedges, 1, length);
            assert_int_equal(w.tags, mirrored ? GD__WINDOW_FAR_SIDE : 0);
            if (mirrored) w = gd__window_mirrored(&w, length);
            assert_true(w.b0 >= 0.3 - 1e-15 && w.b0 < 0.3 + 1e-9 && w.b1 <= 1.7 + 1e-15 &&
                        w.b1 > 1.7 - 1e-9);
            assert_true(fabs(w.x - x[0]) < 4e-16 && fabs(w.y - y[0]) < 4e-16 &&
                        fabs(w.sigma + 0.25) < 2e-15);
            assert_int_equal(w.source, source[0]);
        }
    }
}

/* Returns the largest relative difference between the distances through two windows, at points on
 * the edge and beyond the edge. */
static double worst_difference(const struct gd__window *a, const struct gd__window *b,
                               double length)
{
    double worst = 0;
    for (int k = 0; k <= 8; k++) {
        double t = a->b0 + k / 8.0 * (a->b1 - a->b0);
        for (int far = 0; far < 2; far++) {
            double exact = gd__window_distance_beyond(a, t, far * length),
                   stored = gd__window_distance_beyond(b, t, far * length);
            worst = fmax(worst, fabs(exact - stored) / exact);
        }
    }
    return worst;
}

/* Each form keeps the numbers of sources. It keeps distances of any size to a relative error of
 * 1e-14. */
static void every_form_keeps_distances(void **state)
{
    (void)state;
    struct rng rng = {21};
    const uint32_t most[] = {(1u << 20) - 2, (1u << 28) - 2, UINT32_MAX >> 1};
    uint32_t packed = 0;
    double worst = 0;
    for (int round = 0; round < 3000; round++) {
        enum gd__wedge_form form = round % 3;
        double size = exp2(rng_between(&rng, -40, 40)), length = size * rng_unit(&rng);
        struct gd__window w = {.b1 = length,
                               .x = rng_between(&rng, -size, size),
                               .y = size * exp2(rng_between(&rng, -40, 0)),
                               .sigma = round % 2 ? 0 : size * exp2(rng_between(&rng, -40, 0)),
                               .source = round < 300 ? most[form] - (uint32_t)round / 3
                                                     : (uint32_t)rng_next(&rng) % most[form]};
        struct gd__stack list = {&w, 1, 1};
        struct written written;
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            write_as(&list, length, mirrored, form, &written);
            struct gd__window read = gd__wedge_window(&written.wedges, 0, length),
                              expected = mirrored ? gd__window_mirrored(&w, length) : w;
            read.sigma = w.sigma;
            packed += written.chunk.form != GD__WEDGE_WIDE;
            assert_true(read.y > 0);
            assert_int_equal(read.source, w.source);
            if (written.chunk.form == GD__WEDGE_WIDE)
                assert_true(read.x == expected.x && read.y == expected.y);
            worst = fmax(worst, worst_difference(&expected, &read, length));
        }
    }
    print_message("# %u chunks of 6000 are packed, worst difference %.1e\n", packed, worst);
    assert_true(packed > 1000 && worst < 1e-14);
}

/* Coordinates beyond the range of exponents make a chunk wide. */
static void coordinates_beyond_the_exponents_stay(void **state)
{
    (void)state;
    const double size[] = {0x1p-70, 0x1p64, 0x1p200};
    for (int i = 0; i < 3; i++) {
        struct gd__window w = {
            .b1 = size[i], .x = 0.3 * size[i], .y = size[i], .sigma = size[i], .source = 2};
        struct written written;
        write_as(&(struct gd__stack){&w, 1, 1}, size[i], false, GD__WEDGE_20, &written);
        struct gd__window read = gd__wedge_window(&written.wedges, 0, size[i]);
        assert_int_equal(written.chunk.form, GD__WEDGE_WIDE);
        assert_true(read.x == w.x && read.y == w.y && read.source == 2);
    }
}

static void the_form_depends_on_the_number_of_sources(void **state)
{
    (void)state;
    assert_int_equal(gd__wedge_form_of((1u << 20) - 2), GD__WEDGE_20);
    assert_int_equal(gd__wedge_form_of((1u << 20) - 1), GD__WEDGE_28);
    assert_int_equal(gd__wedge_form_of((1u << 28) - 2), GD__WEDGE_28);
    assert_int_equal(gd__wedge_form_of((1u << 28) - 1), GD__WEDGE_WIDE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(marks_gaps_before_between_and_behind, free_builder),
        cmocka_unit_test_teardown(closes_gaps_of_the_size_of_rounding, free_builder),
        cmocka_unit_test_teardown(the_chunk_stores_the_side, free_builder),
        cmocka_unit_test_teardown(reads_back_what_was_written, free_builder),
        cmocka_unit_test(linear_windows_come_back),
        cmocka_unit_test_teardown(every_form_keeps_distances, free_builder),
        cmocka_unit_test_teardown(coordinates_beyond_the_exponents_stay, free_builder),
        cmocka_unit_test(the_form_depends_on_the_number_of_sources),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
