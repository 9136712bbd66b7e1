#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "field/spans.h"

static void check_span(const struct gd__span *span, double from, double to)
{
    check_close(span->from, from, 1e-13);
    check_close(span->to, to, 1e-13);
}

static void around_an_angle(void **state)
{
    (void)state;
    struct gd__turn turn = gd__turn_around(1, 0.5);
    assert_int_equal(turn.count, 1);
    check_span(&turn.part[0], 1 - M_PI / 3, 1 + M_PI / 3);
    turn = gd__turn_around(3, 0); /* extends beyond pi */
    assert_int_equal(turn.count, 2);
    check_span(&turn.part[0], -M_PI, 3 + M_PI_2 - 2 * M_PI);
    check_span(&turn.part[1], 3 - M_PI_2, M_PI);
    assert_int_equal(gd__turn_around(-3, 0).count, 2);
    assert_int_equal(gd__turn_around(0, 1).count, 0);
    assert_int_equal(gd__turn_around(0, NAN).count, 0);
    turn = gd__turn_around(0, -2);
    check_span(&turn.part[0], -M_PI, M_PI);
}

static void common_turns(void **state)
{
    (void)state;
    struct gd__turn a = gd__turn_around(3, 0), b = gd__turn_around(-3, 0),
                    common = gd__turn_both(&a, &b);
    assert_int_equal(common.count, 2);
    check_span(&common.part[0], -M_PI, 3 + M_PI_2 - 2 * M_PI);
    check_span(&common.part[1], -3 - M_PI_2 + 2 * M_PI, M_PI);
    struct gd__turn c = gd__turn_around(0, 0.99);
    assert_int_equal(gd__turn_both(&a, &c).count, 0);
}

/* If a member covers the angles beyond an end of an uncovered span, this end has the member's
 * number. */
static void uncovered_spans(void **state)
{
    (void)state;
    struct gd__spans covered = {0}, left = {0};
    struct gd__turn first = {2, {{-2, -1, 0, 0}, {1, 2, 0, 0}}}, second = {1, {{-1.5, 0.5, 0, 0}}};
    gd__spans_put(&covered, &first, 7);
    gd__spans_put(&covered, &second, 8);
    gd__spans_invert(&covered, 0.1, &left);
    assert_int_equal(left.count, 3);
    check_span(&left.span[1], 0.5, 1);
    assert_true(left.span[1].from_by == 8 && left.span[1].to_by == 7);
    assert_true(left.span[0].from_by == GD__SPAN_OPEN && left.span[0].to_by == 7);
    assert_true(left.span[2].from_by == 7 && left.span[2].to_by == GD__SPAN_OPEN);
    gd__spans_join(&left);
    assert_int_equal(left.count, 2);
    check_span(&left.span[1], 2, 2 * M_PI - 2);
    assert_true(left.span[1].from_by == 7 && left.span[1].to_by == 7);
    covered.count = 0;
    gd__spans_put(&covered, &gd__turn_all, 3);
    gd__spans_invert(&covered, 0, &left);
    assert_int_equal(left.count, 0);
    assert_true(!covered.status && !left.status);
    free(covered.span);
    free(left.span);
}

/* Joining overlapping spans from time to time changes no complement, except that it may end early
 * if nothing is left. */
static void settled_spans_have_the_same_complement(void **state)
{
    (void)state;
    struct rng rng = {3};
    unsigned full = 0;
    for (int run = 0; run < 300; run++) {
        struct gd__spans plain = {0}, settled = {0}, left[2] = {0};
        uint32_t limit = GD__SPANS_FEW, longest = 0;
        double width = run % 3 ? 0.002 : 0.4;
        bool is_full = false;
        for (uint32_t k = 0; k < 1000; k++) {
            double phi = M_PI * (2 * rng_unit(&rng) - 1);
            struct gd__turn turn = gd__turn_around(phi, cos(width * rng_unit(&rng)));
            gd__spans_put(&plain, &turn, k);
            if (!is_full) gd__spans_put(&settled, &turn, k);
            if (!is_full) is_full = gd__spans_settle(&settled, 1e-6, &limit);
            if (settled.count > longest) longest = settled.count;
        }
        full += is_full;
        assert_true(longest < 1000 && (run % 3 || longest < 80));
        gd__spans_invert(&plain, 1e-6, &left[0]);
        gd__spans_invert(&settled, 1e-6, &left[1]);
        assert_int_equal(left[0].count, left[1].count);
        for (uint32_t i = 0; i < left[0].count; i++) {
            const struct gd__span *a = &left[0].span[i], *b = &left[1].span[i];
            assert_true(a->from == b->from && a->to == b->to);
            assert_true(a->from_by == b->from_by && a->to_by == b->to_by);
        }
        free(plain.span);
        free(settled.span);
        free(left[0].span);
        free(left[1].span);
    }
    assert_in_range(full, 50, 250);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(around_an_angle),
        cmocka_unit_test(common_turns),
        cmocka_unit_test(uncovered_spans),
        cmocka_unit_test(settled_spans_have_the_same_complement),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
