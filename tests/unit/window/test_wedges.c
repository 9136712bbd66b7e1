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
        uint64_t room[1 + 3 * (2 * MOST + 1)];
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
    out->chunk.form = form;
    gd__chunk_write(&builder.at, list->count, length, mirrored, &out->chunk);
    out->count = out->chunk.count;
    assert_true(out->count <= gd__wedges_bound(list->count));
    assert_true(gd__chunk_bytes(&out->chunk) <= gd__chunk_bound(list->count));
    out->wedges = gd__chunk_wedges(&out->chunk);
}

static void write(const struct gd__stack *list, double length, bool mirrored, struct written *out)
{
    write_as(list, length, mirrored, GD__WEDGE_16, out);
    assert_int_equal(out->chunk.form, GD__WEDGE_16);
}

static double x_of(const struct written *w, uint32_t i)
{
    return gd__wedge_unpack(&w->wedges, &w->wedges.x[i]);
}

static double y_of(const struct written *w, uint32_t i)
{
    return gd__wedge_unpack(&w->wedges, &w->wedges.y[i]);
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
    struct gd__window windows[2] = {{.b0 = 1, .b1 = 2, .x = 1, .y = 3, .source = 7},
                                    {.b0 = 3, .b1 = 3.5, .x = 2, .y = 1, .source = 8}};
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
    struct gd__window windows[2] = {{.b0 = d, .b1 = 0.5, .y = 1, .source = 1},
                                    {.b0 = 0.5 + d, .b1 = 1 - d, .y = 1, .source = 2}};
    struct gd__stack list = {windows, 2, 2};
    struct written w;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        write(&list, 1, mirrored, &w);
        assert_int_equal(w.count, 2);
        assert_int_equal(w.wedges.start[0], 0);
        check_wedge(&w, mirrored ? 1 : 0, 1, mirrored ? 0.5 : 0, mirrored ? 1 : 0.5, 1);
    }
}

/* The sign of y stores the side of the source, also where y is zero. */
static void the_sign_of_y_stores_the_side(void **state)
{
    (void)state;
    struct gd__window window = {.b0 = 0, .b1 = 1, .x = 0.25, .y = 0, .source = 3};
    struct gd__stack list = {&window, 1, 1};
    struct written w;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        write(&list, 1, mirrored, &w);
        struct gd__window read = gd__wedge_window(&w.wedges, 0, 1);
        assert_int_equal(read.tags, mirrored ? GD__WINDOW_FAR_SIDE : 0);
        assert_true(read.x == (mirrored ? 0.75 : 0.25) && read.y == 0 && !signbit(read.y));
    }
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
            assert_true(read.x == expected.x && read.y == expected.y &&
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
            written.chunk.form = GD__WEDGE_16;
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

/* Each form keeps numbers and coordinates bit for bit. A coordinate that is too large makes its
 * chunk wide. */
static void every_form_keeps_all_bits(void **state)
{
    (void)state;
    struct rng rng = {21};
    const uint32_t most[] = {UINT16_MAX - 1, (1u << 24) - 2, UINT32_MAX >> 1};
    for (int round = 0; round < 3000; round++) {
        enum gd__wedge_form form = round % 3;
        struct gd__window w = {.b1 = 1,
                               .x = (round % 2 ? -1 : 1) * exp2(rng_between(&rng, -62, 62)),
                               .y = exp2(rng_between(&rng, -62, 62)),
                               .source = round < 300 ? most[form] - (uint32_t)round / 3
                                                     : (uint32_t)rng_next(&rng) % most[form]};
        struct gd__stack list = {&w, 1, 1};
        struct written written;
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            write_as(&list, 1, mirrored, form, &written);
            assert_int_equal(written.chunk.form, form);
            struct gd__window read = gd__wedge_window(&written.wedges, 0, 1);
            assert_true(read.x == (mirrored ? 1 - w.x : w.x) && read.y == w.y);
            assert_int_equal(read.source, w.source);
        }
    }
    struct gd__window far[2] = {{.b1 = 1, .x = -GD__WEDGE_LIMIT, .y = 1, .source = 2},
                                {.b1 = 1, .x = 1, .y = 2 * GD__WEDGE_LIMIT, .source = 2}};
    for (int i = 0; i < 2; i++) {
        struct written written;
        write_as(&(struct gd__stack){&far[i], 1, 1}, 1, false, GD__WEDGE_16, &written);
        struct gd__window read = gd__wedge_window(&written.wedges, 0, 1);
        assert_int_equal(written.chunk.form, GD__WEDGE_WIDE);
        assert_true(read.x == far[i].x && read.y == far[i].y && read.source == 2);
    }
}

static void the_form_depends_on_sources_and_edges(void **state)
{
    (void)state;
    assert_int_equal(gd__wedge_form_of(UINT16_MAX - 1), GD__WEDGE_16);
    assert_int_equal(gd__wedge_form_of(UINT16_MAX), GD__WEDGE_24);
    assert_int_equal(gd__wedge_form_of((1u << 24) - 2), GD__WEDGE_24);
    assert_int_equal(gd__wedge_form_of((1u << 24) - 1), GD__WEDGE_WIDE);
    assert_true(gd__wedges_fit(GD_TOL_PACKED, 0x1p32, 1u << 29));
    assert_false(gd__wedges_fit(0.9 * GD_TOL_PACKED, 1, 100));
    assert_false(gd__wedges_fit(1, 0x1p32, 1u << 30));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(marks_gaps_before_between_and_behind, free_builder),
        cmocka_unit_test_teardown(closes_gaps_of_the_size_of_rounding, free_builder),
        cmocka_unit_test_teardown(the_sign_of_y_stores_the_side, free_builder),
        cmocka_unit_test_teardown(reads_back_what_was_written, free_builder),
        cmocka_unit_test(linear_windows_come_back),
        cmocka_unit_test_teardown(every_form_keeps_all_bits, free_builder),
        cmocka_unit_test(the_form_depends_on_sources_and_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
