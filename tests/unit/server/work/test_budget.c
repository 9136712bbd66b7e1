#include "tests/unit/server/support.h"

#include "server/work/budget.h"

static void counts_by_class(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 60));
    assert_false(server_budget_take(&budget, SERVER_BUDGET_MESHES, 41));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_MESHES, 40));
    server_budget_move(&budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_FIELDS, 60);
    assert_int_equal(budget.used[SERVER_BUDGET_FIELDS], 60);
    assert_int_equal(server_budget_available(&budget), 60); /* fields could be evicted */
    server_budget_give(&budget, SERVER_BUDGET_FIELDS, 60);
    assert_int_equal(budget.total, 40);
}

static void sums_do_not_overflow(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 50));
    assert_false(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, SIZE_MAX));
    assert_false(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, SIZE_MAX - 49));
    assert_int_equal(budget.total, 50);
}

static void adjusts_to_what_is_held(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 80));
    server_budget_adjust(&budget, SERVER_BUDGET_FLIGHT, 80, 30);
    assert_int_equal(budget.total, 30);
    /* the memory is already allocated, so it is counted */
    server_budget_adjust(&budget, SERVER_BUDGET_FLIGHT, 30, 120);
    assert_int_equal(budget.total, 120);
    assert_int_equal(server_budget_available(&budget), 0);
    assert_false(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 1));
}

static void idle_workspaces_are_available_and_spare_memory_is_not(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_WORKSPACES, 30));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_SPARE, 10));
    assert_int_equal(server_budget_available(&budget), 90);
}

static size_t count_walks(void *user)
{
    (*(int *)user)++;
    return 40;
}

static void walks_the_meshes_only_when_memory_is_short(void **state)
{
    (void)state;
    struct server_budget budget;
    int walks = 0;
    server_budget_init(&budget, 100);
    budget.reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){NULL, count_walks, &walks};
    assert_true(server_budget_take(&budget, SERVER_BUDGET_MESHES, 70));
    assert_true(server_budget_could_take(&budget, 30));
    assert_int_equal(walks, 0);
    assert_true(server_budget_could_take(&budget, 70));
    assert_false(server_budget_could_take(&budget, 71));
    assert_false(server_budget_could_take(&budget, SIZE_MAX));
    assert_int_equal(walks, 3);
}

static void reclaim_workspaces(void *user, size_t bytes)
{
    struct server_budget *budget = user;
    (void)bytes;
    server_budget_give(budget, SERVER_BUDGET_WORKSPACES, budget->used[SERVER_BUDGET_WORKSPACES]);
}

static void reclaim_fields(void *user, size_t bytes)
{
    struct server_budget *budget = user;
    assert_int_equal(bytes, 10);
    server_budget_give(budget, SERVER_BUDGET_FIELDS, 40);
}

static void reclaims_the_missing_bytes(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FIELDS, 90));
    assert_false(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 20));
    budget.reclaimers[SERVER_RECLAIM_FIELDS] =
        (struct server_reclaimer){reclaim_fields, NULL, &budget};
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 20));
    assert_int_equal(budget.total, 70);
}

static void workspaces_go_before_fields(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    budget.reclaimers[SERVER_RECLAIM_WORKSPACES] =
        (struct server_reclaimer){reclaim_workspaces, NULL, &budget};
    budget.reclaimers[SERVER_RECLAIM_FIELDS] =
        (struct server_reclaimer){reclaim_fields, NULL, &budget};
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FIELDS, 60));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_WORKSPACES, 35));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 40));
    assert_int_equal(budget.used[SERVER_BUDGET_FIELDS], 60);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 10));
    assert_int_equal(budget.used[SERVER_BUDGET_FIELDS], 20);
}

static void evicts_nothing_if_that_would_not_suffice(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 100);
    budget.reclaimers[SERVER_RECLAIM_FIELDS] =
        (struct server_reclaimer){reclaim_fields, NULL, &budget};
    assert_true(server_budget_take(&budget, SERVER_BUDGET_MESHES, 50));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FIELDS, 50));
    assert_false(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 51));
    assert_int_equal(budget.used[SERVER_BUDGET_FIELDS], 50);
}

#define KIB ((size_t)1 << 10)

static void answers_leave_a_part_to_other_classes(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 1024 * KIB);
    assert_int_equal(budget.largest_answer, 512 * KIB);
    assert_true(server_share_take_answer(&budget.common, 500 * KIB));
    /* all answers together may take half of the budget */
    assert_false(server_share_take_answer(&budget.common, 100 * KIB));
    /* small answers may take three quarters of the budget */
    assert_true(server_share_take_answer(&budget.common, 60 * KIB));
    for (int i = 0; i < 3; i++) assert_true(server_share_take_answer(&budget.common, 64 * KIB));
    assert_false(server_share_take_answer(&budget.common, 64 * KIB)); /* exceeds this part */
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, 200 * KIB));
    assert_int_equal(server_budget_available(&budget), 1024 * KIB - budget.total);
    server_budget_give(&budget, SERVER_BUDGET_ANSWERS, budget.used[SERVER_BUDGET_ANSWERS]);
    assert_int_equal(budget.total, 200 * KIB);
}

static void give_fields(void *user, size_t bytes)
{
    server_budget_give(user, SERVER_BUDGET_FIELDS, bytes);
}

static void answers_can_evict_fields(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 1024 * KIB);
    budget.reclaimers[SERVER_RECLAIM_FIELDS] =
        (struct server_reclaimer){give_fields, NULL, &budget};
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FIELDS, 1000 * KIB));
    assert_true(server_share_take_answer(&budget.common, 500 * KIB));
    assert_false(server_share_take_answer(&budget.common, SIZE_MAX));
    assert_int_equal(budget.used[SERVER_BUDGET_ANSWERS], 500 * KIB);
}

static void texts_count_as_answers(void **state)
{
    (void)state;
    struct server_budget budget;
    server_budget_init(&budget, 1024 * KIB);
    const struct proto_writer_account *account = &budget.common.account;
    assert_true(account->take(account->user, 10 * KIB));
    assert_int_equal(budget.used[SERVER_BUDGET_ANSWERS], 10 * KIB);
    account->give(account->user, 10 * KIB);
    assert_int_equal(budget.total, 0);
}

static void a_tenant_leaves_as_much_as_it_takes(void **state)
{
    (void)state;
    struct server_budget budget;
    struct server_share ann, bob;
    server_budget_init(&budget, 1024 * KIB);
    server_share_init(&ann, &budget, true);
    server_share_init(&bob, &budget, true);
    assert_true(server_share_take_body(&ann, 512 * KIB));
    assert_false(server_share_take_body(&ann, 1));
    assert_true(server_share_take_body(&bob, 256 * KIB));
    assert_false(server_share_take_body(&bob, 1));
    assert_false(server_share_take_body(&bob, SIZE_MAX));
    server_share_give_body(&ann, 512 * KIB);
    assert_true(server_share_take_body(&bob, 128 * KIB));
    server_share_give_body(&bob, 384 * KIB);
    assert_int_equal(server_share_largest_answer(&ann), 256 * KIB);
    assert_int_equal(server_share_largest_answer(&budget.common), 512 * KIB);
    assert_true(server_share_take_answer(&ann, 256 * KIB));
    assert_false(server_share_take_answer(&ann, 128 * KIB));
    assert_false(server_share_move_to_answers(&ann, 128 * KIB));
    assert_int_equal(budget.refused_answers, 0); /* this lack is the tenant's own */
    assert_true(server_share_take_answer(&bob, 128 * KIB));
    server_share_give_answer(&ann, 256 * KIB);
    server_share_give_answer(&bob, 128 * KIB);
    assert_int_equal(budget.total + budget.bodies + ann.answers + bob.bodies, 0);
}

static void answers_of_dropped_jobs_count_as_unread(void **state)
{
    (void)state;
    struct server_budget budget;
    struct server_share ann;
    server_budget_init(&budget, 1024 * KIB);
    server_share_init(&ann, &budget, true);
    assert_true(server_budget_take(&budget, SERVER_BUDGET_JOBS, 300 * KIB));
    server_share_adopt_job(&ann, 300 * KIB);
    assert_int_equal(budget.used[SERVER_BUDGET_ANSWERS], 300 * KIB);
    assert_false(server_share_take_answer(&ann, 100 * KIB));
    server_share_give_answer(&ann, 300 * KIB);
    assert_int_equal(budget.total, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_by_class),
        cmocka_unit_test(sums_do_not_overflow),
        cmocka_unit_test(adjusts_to_what_is_held),
        cmocka_unit_test(idle_workspaces_are_available_and_spare_memory_is_not),
        cmocka_unit_test(walks_the_meshes_only_when_memory_is_short),
        cmocka_unit_test(reclaims_the_missing_bytes),
        cmocka_unit_test(workspaces_go_before_fields),
        cmocka_unit_test(evicts_nothing_if_that_would_not_suffice),
        cmocka_unit_test(answers_leave_a_part_to_other_classes),
        cmocka_unit_test(answers_can_evict_fields),
        cmocka_unit_test(texts_count_as_answers),
        cmocka_unit_test(a_tenant_leaves_as_much_as_it_takes),
        cmocka_unit_test(answers_of_dropped_jobs_count_as_unread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
