/* A page is allocated at its first use. If none of its records was in the queue while the queue
 * processed some buckets, the memory is reused for another page. Pages with `stays` are never
 * reused. */
#include "tests/support/test.h"

#include "wavefront/pages.h"

enum {
    COUNT = 40,
    PAGES_A_SLAB = 32,
    SLAB = PAGES_A_SLAB * 48 + 8,
    MADE_MOST = 4,
    LONG = 1000 /* number of buckets; a page that is idle for this number can be reused */
};

struct numbers {
    struct gd__page page;
    uint32_t number[4];
};

static struct gd__pages pages;

static int open_pages(void **state)
{
    (void)state;
    check_ok(gd__pages_open(&pages, COUNT, sizeof(struct numbers), MADE_MOST, NULL), NULL);
    return 0;
}

static int close_pages(void **state)
{
    (void)state;
    gd__pages_close(&pages);
    return pages.page ? -1 : 0;
}

/* Allocates a page that has no queued record. */
static struct gd__page *make(uint32_t number, uint32_t now)
{
    check_ok(gd__pages_make(&pages, number, now), NULL);
    assert_true(pages.page[number] && pages.page[number]->number == number);
    gd__pages_rest(&pages, pages.page[number], now);
    return pages.page[number];
}

static void rested_pages_are_used_again(void **state)
{
    (void)state;
    struct gd__page *first = make(0, 10), *second = make(1, 10);
    struct gd__page *third = make(2, 11); /* too early to reuse a page */
    assert_true(pages.page[0] == first && pages.page[1] == second && third != first &&
                third != second);
    assert_ptr_equal(make(3, LONG), first);
    assert_null(pages.page[0]);
    assert_ptr_equal(make(4, LONG), second);
}

static void pages_that_woke_up_stay_where_they_are(void **state)
{
    (void)state;
    struct gd__page *awake = make(0, 10), *drowsy = make(1, 10), *asleep = make(2, 10);
    awake->waiting = 1;
    gd__pages_rest(&pages, drowsy, LONG); /* a record of this page was in the queue meanwhile */
    assert_ptr_equal(make(3, LONG), asleep);
    assert_true(pages.page[0] == awake && pages.page[1] == drowsy);
    awake->waiting = 0;
    gd__pages_rest(&pages, awake, 2 * LONG);
    assert_ptr_equal(make(4, 2 * LONG), drowsy);
    assert_ptr_equal(pages.page[0], awake);
    assert_ptr_equal(make(5, 3 * LONG), asleep); /* this memory belonged to page 3 */
    assert_ptr_equal(make(6, 3 * LONG), awake);
}

static void pages_that_stay_are_kept(void **state)
{
    (void)state;
    struct gd__page *page = make(0, 10);
    page->stays = true;
    for (uint32_t i = 1; i < COUNT; i++) assert_ptr_not_equal(make(i, i * LONG), page);
    assert_ptr_equal(pages.page[0], page);
}

/* Two pages are needed alternately. After some reallocations both stay. */
static void a_page_made_often_stays(void **state)
{
    (void)state;
    uint32_t makes = 0;
    for (uint32_t now = LONG; now < 100 * LONG; now += LONG) {
        uint32_t number = (now / LONG) % 2;
        if (pages.page[number]) continue;
        make(number, now);
        makes++;
    }
    assert_true(pages.page[0] && pages.page[1]);
    assert_in_range(makes, 4, 20);
}

static void the_budget_is_kept(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = COUNT * (sizeof(void *) + 1) + SLAB};
    struct gd__budget budget = {.control = &control};
    gd__pages_close(&pages);
    check_ok(gd__pages_open(&pages, COUNT, sizeof(struct numbers), MADE_MOST, &budget), NULL);
    for (uint32_t i = 0; i < PAGES_A_SLAB; i++) make(i, 10)->waiting = i > 0;
    assert_int_equal(gd__pages_make(&pages, PAGES_A_SLAB, 10), GD_BUDGET);
    assert_null(pages.page[PAGES_A_SLAB]);
    make(PAGES_A_SLAB, LONG); /* reuses the memory of page 0 */
    control.budget_bytes = 1;
    gd__pages_close(&pages);
    budget.held = 0;
    assert_int_equal(gd__pages_open(&pages, COUNT, sizeof(struct numbers), MADE_MOST, &budget),
                     GD_BUDGET);
    assert_null(pages.page);
}

#define WITH_PAGES(test) cmocka_unit_test_setup_teardown(test, open_pages, close_pages)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_PAGES(rested_pages_are_used_again), WITH_PAGES(pages_that_woke_up_stay_where_they_are),
        WITH_PAGES(pages_that_stay_are_kept),    WITH_PAGES(a_page_made_often_stays),
        WITH_PAGES(the_budget_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
