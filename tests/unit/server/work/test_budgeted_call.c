/* Calls of the engine within the byte budget: what they are granted, and what is held afterwards.
 */
#include "tests/unit/server/support.h"

#include "server/work/budgeted_call.h"

static struct {
    struct server_budget budget;
    struct server_workspaces *workspaces;
} server;
static int walks;

/* Needs `need` bytes and keeps `keep` of them. */
struct task {
    size_t need, keep;
    size_t grants[8];
    int attempts;
};

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct task *task = user;
    task->grants[task->attempts++] = control->budget_bytes;
    if (control->budget_bytes < task->need) return GD_BUDGET;
    *kept = task->keep;
    return GD_OK;
}

static size_t walk(void *user)
{
    (void)user;
    walks++;
    return 0;
}

static int set_up(void **state)
{
    (void)state;
    memset(&server, 0, sizeof server);
    server_budget_init(&server.budget, 1 << 20);
    server.budget.reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){NULL, walk, NULL};
    server.workspaces = server_workspaces_create(&server.budget, 1);
    walks = 0;
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    server_workspaces_destroy(server.workspaces);
    return 0;
}

static enum gd_status call(struct task *task, size_t grant)
{
    const struct server_budgeted_call call = {.make = make, .user = task, .grant = grant};
    return server_budgeted_call_run(server.workspaces, &call);
}

static void one_that_makes_do_with_its_grant_looks_no_further(void **state)
{
    (void)state;
    struct task task = {.need = 1000, .keep = 100};
    assert_int_equal(call(&task, 1000), GD_OK);
    assert_int_equal(task.attempts, 1);
    assert_int_equal(server.budget.used[SERVER_BUDGET_FLIGHT], 100);
    /* over all meshes, for what could be had: a search can't wait for that */
    assert_int_equal(walks, 0);
}

static void one_that_needs_more_is_made_again_with_more(void **state)
{
    (void)state;
    struct task task = {.need = 10000};
    assert_int_equal(call(&task, 1000), GD_OK);
    assert_int_equal(task.attempts, 3);
    assert_int_equal(task.grants[2], 16000);
    assert_int_equal(server.budget.used[SERVER_BUDGET_FLIGHT], 0);
}

static void the_last_attempt_has_all_that_can_be_had(void **state)
{
    (void)state;
    struct task fits = {.need = 900000}, does_not_fit = {.need = (1 << 20) + 1};
    assert_int_equal(call(&fits, 100000), GD_OK);
    assert_int_equal(call(&does_not_fit, 100000), GD_BUDGET);
    assert_int_equal(does_not_fit.attempts, 3);
    assert_int_equal(does_not_fit.grants[2], server_budget_available(&server.budget));
    assert_int_equal(server.budget.used[SERVER_BUDGET_FLIGHT], 0);
}

static void one_for_which_nothing_is_left_is_not_made(void **state)
{
    (void)state;
    struct task task = {.need = 1};
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, server.budget.limit));
    assert_int_equal(call(&task, 1000), GD_BUDGET);
    assert_int_equal(task.attempts, 0);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(one_that_makes_do_with_its_grant_looks_no_further),
        TEST(one_that_needs_more_is_made_again_with_more),
        TEST(the_last_attempt_has_all_that_can_be_had),
        TEST(one_for_which_nothing_is_left_is_not_made),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
