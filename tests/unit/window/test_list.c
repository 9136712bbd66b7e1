/* Tests that a list is the lower envelope of the offered windows. It is sorted and disjoint, and
 * gives nowhere a larger distance than any offered window. */
#include "tests/unit/window/model.h"

#include "gd/polygons.h"

#define OFFERED 12

/* --- a list and the offered windows ----------------------------------------------------------- */

static struct gd__pool pool;
static struct gd__list list;
static struct gd__scratch scratch;
static struct gd__children newer;
static struct gd__stack offered, actual;

static int open_list(void **state)
{
    (void)state;
    gd__pool_init(&pool, GD__LIST_POOL_ITEM, NULL);
    list = (struct gd__list){0};
    newer = (struct gd__children){0};
    offered.count = 0;
    scratch.apart = false;
    return 0;
}

static int close_list(void **state)
{
    (void)state;
    gd__pool_destroy(&pool);
    gd__scratch_destroy(&scratch);
    gd__stack_destroy(&offered);
    gd__stack_destroy(&actual);
    return 0;
}

static void empty_list(void)
{
    if (list.block) gd__pool_release(&pool, list.block, list.size_class);
    list = (struct gd__list){0};
    offered.count = 0;
}

/* Inserts the last `count` of the offered windows, which may overlap. */
static void insert_last(uint32_t count)
{
    struct gd__stack batch = {offered.windows + offered.count - count, count, count};
    build_children(&batch, 0, &pool, &newer);
    check_ok(gd__children_sort(&newer, &pool, WIDTH, &scratch), NULL);
    check_ok(gd__list_insert(&list, &pool, &newer, WIDTH, &scratch), NULL);
}

static void check_list(void)
{
    struct gd__windows windows = gd__list_windows(&list);
    load_windows(&windows, list.count, &actual);
    check_envelope(&actual, &offered);
}

/* --- pushing ---------------------------------------------------------------------------------- */

static void pushing_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {11};
    struct gd__stack pushed = {0};
    for (int round = 0; round < 2000; round++) {
        pushed.count = offered.count = 0;
        for (uint32_t i = 0; i < OFFERED; i++) {
            append_window(&offered, random_window(&rng, i));
            check_ok(gd__stack_push(&pushed, &offered.windows[i], WIDTH, &scratch.stack[1]), NULL);
        }
        check_envelope(&pushed, &offered);
        check_pieces(&pushed, &offered);
    }
    gd__stack_destroy(&pushed);
}

/* --- untangling ------------------------------------------------------------------------------- */

/* Returns windows that are nearly in order, as after a cast. Some windows begin slightly before the
 * end of the previous window, and a few begin far before this end. */
static struct gd__window nearly_next(struct rng *rng, uint32_t i, uint32_t count)
{
    struct gd__window w = random_window(rng, i);
    double reach = rng_unit(rng) < 0.05 ? 1 : 0.1;
    w.b0 = fmax(0, (double)i / count - rng_between(rng, 0, reach));
    w.b1 = fmin(1, (double)(i + 1) / count + rng_between(rng, -0.5 / count, 0.1));
    return w;
}

static void untangling_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {13};
    for (int round = 0; round < 2000; round++) {
        uint32_t count = 1 + rng_below(&rng, 40), in_order = rng_below(&rng, count + 1);
        bool in_any_order = round % 3 == 0;
        offered.count = 0;
        for (uint32_t i = 0; i < count; i++) {
            struct gd__window w =
                in_any_order ? random_window(&rng, i) : nearly_next(&rng, i, count);
            if (i < in_order) { /* windows before `from` are disjoint and in order */
                w.b0 = (double)i / count;
                w.b1 = (double)(i + 1) / count;
            }
            append_window(&offered, w);
        }
        build_children(&offered, in_order, &pool, &newer);
        check_ok(gd__children_sort(&newer, &pool, WIDTH, &scratch), NULL);
        assert_int_equal(newer.tangled, GD_NONE);
        load_windows(&newer.at, newer.count, &actual);
        check_envelope(&actual, &offered);
        check_pieces(&actual, &offered);
    }
}

/* Adjacent windows of one source are merged unless `apart` is set. */
static void untangling_joins_neighbours(void **state)
{
    (void)state;
    for (int apart = 0; apart < 2; apart++) {
        scratch.apart = apart;
        offered.count = 0;
        for (int i = 0; i < 10; i++)
            append_window(&offered,
                          (struct gd__window){
                              .b0 = i / 10.0, .b1 = (i + 1) / 10.0, .x = 0.5, .y = 2, .source = 3});
        build_children(&offered, 0, &pool, &newer);
        check_ok(gd__children_sort(&newer, &pool, WIDTH, &scratch), NULL);
        assert_int_equal(newer.count, apart ? 10 : 1);
        assert_true(newer.at.b0[0] == 0 && newer.at.b1[newer.count - 1] == 1);
    }
}

/* --- inserting -------------------------------------------------------------------------------- */

static void inserting_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {12};
    for (int round = 0; round < 2000; round++) {
        empty_list();
        for (uint32_t i = 0; i < OFFERED; i++) {
            append_window(&offered, random_window(&rng, i));
            if (i % 3 == 2) insert_last(3);
        }
        check_list();
        check_pieces(&actual, &offered);
    }
}

/* Offers windows of different sources with the given pieces, and inserts them together. */
static void insert_pieces(struct rng *rng, const double (*pieces)[2], uint32_t count, double sigma)
{
    for (uint32_t i = 0; i < count; i++) {
        struct gd__window w = random_window(rng, offered.count);
        w.b0 = pieces[i][0];
        w.b1 = pieces[i][1];
        w.sigma += sigma;
        append_window(&offered, w);
    }
    insert_last(count);
}

#define PIECES(...)                                                                                \
    ((const double[][2]){__VA_ARGS__}),                                                            \
        (uint32_t)(sizeof((double[][2]){__VA_ARGS__}) / sizeof(double[2]))

static void appends(void **state)
{
    (void)state;
    struct rng rng = {1};
    insert_pieces(&rng, PIECES({0, 0.1}, {0.1, 0.3}), 0);
    /* the new window touches an existing window */
    insert_pieces(&rng, PIECES({0.3, 0.5}, {0.6, 0.7}), 0);
    insert_pieces(&rng, PIECES({0.8, 1}), 0); /* leaves a gap */
    assert_int_equal(list.count, 5);
    check_list();
}

static void prepends(void **state)
{
    (void)state;
    struct rng rng = {2};
    insert_pieces(&rng, PIECES({0.8, 1}), 0);
    insert_pieces(&rng, PIECES({0.3, 0.5}, {0.6, 0.8}), 0);
    insert_pieces(&rng, PIECES({0, 0.1}, {0.1, 0.2}), 0);
    assert_int_equal(list.count, 5);
    check_list();
}

/* If the ends of two windows overlap by less than the least width, they are cut so that they meet,
 * without a contest. */
static void ends_that_touch_are_cut(void **state)
{
    (void)state;
    struct rng rng = {3};
    insert_pieces(&rng, PIECES({0.3, 0.6}), 0);
    insert_pieces(&rng, PIECES({0.6 - WIDTH / 2, 1}), 0);
    insert_pieces(&rng, PIECES({0, 0.3 + WIDTH / 2}), 0);
    struct gd__windows w = gd__list_windows(&list);
    assert_int_equal(list.count, 3);
    assert_true(w.b1[0] == w.b0[1] && w.b1[1] == w.b0[2]);
}

static void fills_a_gap(void **state)
{
    (void)state;
    struct rng rng = {4};
    insert_pieces(&rng, PIECES({0, 0.1}, {0.2, 0.3}, {0.9, 1}), 0);
    insert_pieces(&rng, PIECES({0.4, 0.5}, {0.5, 0.6}, {0.7, 0.8}), 0);
    assert_int_equal(list.count, 6);
    check_list();
}

/* The newer windows overlap the list on both sides. In the middle, they give shorter distances, or
 * give longer distances (by sigma), or have a gap. */
static void overlaps_in_the_middle(void **state)
{
    (void)state;
    struct rng rng = {5};
    for (int round = 0; round < 300; round++) {
        empty_list();
        insert_pieces(&rng, PIECES({0, 0.1}, {0.4, 0.5}, {0.5, 0.62}, {0.93, 1}), 0.3);
        double sigma = round % 3 == 0 ? 3 : round % 3 == 1 ? -0.2 : 0.3;
        if (round % 2)
            insert_pieces(
                &rng, PIECES({0.15, 0.2}, {0.2, 0.3}, {0.35, 0.7}, {0.7, 0.8}, {0.8, 0.9}), sigma);
        else
            insert_pieces(&rng, PIECES({0.15, 0.2}, {0.2, 0.3}, {0.7, 0.8}, {0.85, 0.9}), sigma);
        check_list();
        check_pieces(&actual, &offered);
    }
}

static struct gd__window of_source(double b0, double b1, uint32_t source)
{
    return (struct gd__window){
        .b0 = b0, .b1 = b1, .x = 0.3 * source, .y = 0.5 + 0.1 * source, .source = source};
}

/* Adjacent windows of one source are merged at one end of the inserted windows or at both. */
static void joins_at_both_seams(void **state)
{
    (void)state;
    append_window(&offered, of_source(0, 0.3, 1));
    append_window(&offered, of_source(0.6, 1, 2));
    insert_last(2);
    append_window(&offered, of_source(0.3, 0.45, 1));
    append_window(&offered, of_source(0.45, 0.6, 2));
    insert_last(2);
    struct gd__windows w = gd__list_windows(&list);
    assert_int_equal(list.count, 2);
    assert_true(w.b0[0] == 0 && w.b1[0] == 0.45 && w.b0[1] == 0.45 && w.b1[1] == 1);
    check_list();
    empty_list(); /* now there are contested windows between the ends */
    append_window(&offered, of_source(0, 0.2, 1));
    append_window(&offered, of_source(0.4, 0.6, 3));
    append_window(&offered, of_source(0.8, 1, 2));
    insert_last(3);
    append_window(&offered, of_source(0.2, 0.3, 1));
    append_window(&offered, of_source(0.35, 0.7, 4));
    append_window(&offered, of_source(0.7, 0.8, 2));
    insert_last(3);
    w = gd__list_windows(&list);
    assert_true(w.b0[0] == 0 && w.b1[0] == 0.3 && w.b0[list.count - 1] == 0.7 &&
                w.b1[list.count - 1] == 1);
    check_list();
}

static void neighbours_stay_apart_if_requested(void **state)
{
    (void)state;
    scratch.apart = true;
    append_window(&offered, of_source(0, 0.3, 1));
    append_window(&offered, of_source(0.6, 1, 1));
    insert_last(2);
    append_window(&offered, of_source(0.3, 0.6, 1));
    insert_last(1);
    assert_int_equal(list.count, 3);
    check_list();
}

static void neighbours_that_see_one_source_become_one(void **state)
{
    (void)state;
    static const double ends[4][2] = {{0, 0.25}, {0.75, 1}, {0.25, 0.5}, {0.5, 0.75}};
    for (int i = 0; i < 4; i++) {
        append_window(&offered, of_source(ends[i][0], ends[i][1], 3));
        insert_last(1);
    }
    struct gd__windows w = gd__list_windows(&list);
    /* the last window touches both other windows and is merged with one of them */
    assert_true(list.count <= 2);
    assert_true(w.b0[0] == 0 && w.b1[list.count - 1] == 1);
    check_list();
}

/* Inserts hundreds of windows at all positions of lists of up to several groups. Blocks grow, and
 * no window is lost. */
static void blocks_grow(void **state)
{
    (void)state;
    struct rng rng = {6};
    enum { PLACES = 40, MOST = 40 };
    for (int round = 0; round < 30; round++) {
        uint32_t order[PLACES], total = 0;
        empty_list();
        for (uint32_t i = 0; i < PLACES; i++) {
            uint32_t k = rng_below(&rng, i + 1);
            order[i] = order[k];
            order[k] = i;
        }
        for (uint32_t i = 0; i < PLACES; i++) {
            double step = 1.0 / PLACES, from = step * order[i];
            uint32_t count = 1 + rng_below(&rng, MOST);
            for (uint32_t k = 0; k < count; k++) {
                struct gd__window w = random_window(&rng, total + k);
                w.b0 = from + step * k / count;
                w.b1 = from + step * (k + 1) / count;
                append_window(&offered, w);
            }
            insert_last(count);
            total += count;
            assert_true(list.count <= total && list.count <= gd__list_capacity(&list));
        }
        check_list();
        check_pieces(&actual, &offered);
        assert_int_equal(list.count, total);
    }
}

/* --- one window ------------------------------------------------------------------------------- */

static void insert_one(void)
{
    const struct gd__window *w = &offered.windows[offered.count - 1];
    check_ok(list.count ? gd__list_add_one(&list, &pool, w, WIDTH, &scratch)
                        : gd__list_begin(&list, &pool, w),
             NULL);
    assert_true(list.count + GD__WINDOWS_GROUP <= gd__list_capacity(&list));
}

static void one_by_one_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {21};
    for (int round = 0; round < 3000; round++) {
        empty_list();
        for (uint32_t i = 0; i < OFFERED; i++) {
            append_window(&offered, random_window(&rng, i));
            insert_one();
            check_list();
        }
        check_pieces(&actual, &offered);
    }
}

/* Returns a linear window at similar distances as the windows of random_window. */
static struct gd__window random_line(struct rng *rng, uint32_t source)
{
    struct gd__window w = random_window(rng, source | GD__SOURCE_LINEAR);
    double angle = rng_between(rng, 0.01, 3.13);
    w.x = cos(angle);
    w.y = sin(angle);
    w.sigma = 1 + rng_between(rng, 0, 0.5);
    return w;
}

static void lines_one_by_one_give_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {22};
    for (int round = 0; round < 3000; round++) {
        empty_list();
        for (uint32_t i = 0; i < OFFERED; i++) {
            append_window(&offered,
                          rng_below(&rng, 3) ? random_line(&rng, i) : random_window(&rng, i));
            insert_one();
            check_list();
        }
    }
}

/* In a tie the existing window stays. A window that begins where another one ends does not overlap
 * it. Adjacent windows of one source are merged. */
static void one_window_beside_others(void **state)
{
    (void)state;
    append_window(&offered,
                  (struct gd__window){.b0 = 0.2, .b1 = 0.6, .x = 0.5, .y = 1, .source = 0});
    insert_one();
    append_window(&offered,
                  (struct gd__window){.b0 = 0.1, .b1 = 0.7, .x = 0.5, .y = 1, .source = 1});
    insert_one();
    append_window(&offered,
                  (struct gd__window){.b0 = 0.7, .b1 = 0.9, .x = 0.5, .y = 1, .source = 1});
    insert_one();
    struct gd__windows w = gd__list_windows(&list);
    const double from[3] = {0.1, 0.2, 0.6}, to[3] = {0.2, 0.6, 0.9};
    assert_int_equal(list.count, 3);
    for (uint32_t i = 0; i < 3; i++)
        assert_true(w.b0[i] == from[i] && w.b1[i] == to[i] && w.source[i] == (i != 1));
}

/* Uses three linear windows and the window of a point. At both ends of a linear window, the linear
 * window gives shorter distances than the point's window; in the middle it gives longer distances.
 * This gives the largest possible number of parts, so the block must grow. */
static void one_window_may_leave_thirteen_parts(void **state)
{
    (void)state;
    const struct gd__window point = {.b0 = 0, .b1 = 1, .x = 0.5, .y = 0.1, .source = 3};
    const double from[3] = {0.05, 0.4, 0.7}, to[3] = {0.3, 0.6, 0.95};
    for (uint32_t i = 0; i < 3; i++) { /* the linear distance is a chord of the point's distance,
                                        * reduced by 1e-4 */
        double d0 = gd__window_distance(&point, from[i]), d1 = gd__window_distance(&point, to[i]),
               slope = (d1 - d0) / (to[i] - from[i]);
        append_window(&offered, (struct gd__window){.b0 = from[i],
                                                    .b1 = to[i],
                                                    .x = -slope,
                                                    .y = sqrt(1 - slope * slope),
                                                    .sigma = d0 - slope * from[i] - 1e-4,
                                                    .source = i | GD__SOURCE_LINEAR});
        insert_one();
    }
    append_window(&offered, point);
    insert_one();
    assert_int_equal(list.count, 13);
    check_list();
    for (uint32_t i = 0; i < 13; i++) assert_int_equal(actual.windows[i].source == 3, i % 2 == 0);
}

static void single_windows_stay_apart_if_requested(void **state)
{
    (void)state;
    scratch.apart = true;
    for (int i = 0; i < 3; i++) {
        append_window(&offered,
                      (struct gd__window){.b0 = i / 3.0, .b1 = (i + 1) / 3.0, .x = 0.5, .y = 1});
        insert_one();
    }
    assert_int_equal(list.count, 3);
}

/* --- memory ----------------------------------------------------------------------------------- */

/* Inserts adjacent windows one at a time until the budget is spent. The list remains intact. */
static void budget_is_kept(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 1 << 20};
    struct gd__budget budget = {.control = &control, .held = 1000};
    gd__pool_destroy(&pool);
    gd__pool_init(&pool, GD__LIST_POOL_ITEM, &budget);
    struct rng rng = {7};
    enum gd_status status = GD_OK;
    uint32_t count = 0;
    for (; !status; count++) {
        append_window(&offered, random_window(&rng, count));
        struct gd__window *w = &offered.windows[count];
        w->b0 = count;
        w->b1 = count + 1;
        status = gd__children_open(&newer, &pool, 1);
        if (status) break;
        gd__windows_put(&newer.at, 0, w);
        newer.count = 1;
        status = gd__list_insert(&list, &pool, &newer, WIDTH, &scratch);
        assert_true(pool.bytes + 1000 <= control.budget_bytes && budget.held == pool.bytes + 1000);
    }
    assert_int_equal(status, GD_BUDGET);
    assert_true(pool.bytes > control.budget_bytes / 4);
    struct gd__windows windows = gd__list_windows(&list);
    for (uint32_t i = 0; i < list.count; i++)
        assert_true(windows.b0[i] == i && windows.source[i] == i);
    assert_true(list.count >= count - 1);
}

#define WITH_LIST(test) cmocka_unit_test_setup_teardown(test, open_list, close_list)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_LIST(pushing_gives_the_envelope),
        WITH_LIST(untangling_gives_the_envelope),
        WITH_LIST(untangling_joins_neighbours),
        WITH_LIST(inserting_gives_the_envelope),
        WITH_LIST(appends),
        WITH_LIST(prepends),
        WITH_LIST(ends_that_touch_are_cut),
        WITH_LIST(fills_a_gap),
        WITH_LIST(overlaps_in_the_middle),
        WITH_LIST(joins_at_both_seams),
        WITH_LIST(neighbours_stay_apart_if_requested),
        WITH_LIST(neighbours_that_see_one_source_become_one),
        WITH_LIST(blocks_grow),
        WITH_LIST(one_by_one_gives_the_envelope),
        WITH_LIST(lines_one_by_one_give_the_envelope),
        WITH_LIST(one_window_beside_others),
        WITH_LIST(one_window_may_leave_thirteen_parts),
        WITH_LIST(single_windows_stay_apart_if_requested),
        WITH_LIST(budget_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
