#include "tests/unit/server/support.h"

#include "server/work/workspaces.h"

struct fixture {
    struct server_budget budget;
    struct server_workspaces *workspaces;
    struct gd_mesh *mesh;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    server_budget_init(&fixture->budget, (size_t)1 << 30);
    fixture->workspaces = server_workspaces_create(&fixture->budget, 2);
    fixture->mesh = new_mesh();
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_workspaces_destroy(fixture->workspaces);
    assert_int_equal(fixture->budget.total, 0);
    gd_mesh_release(fixture->mesh);
    free(fixture);
    return 0;
}

/* Builds a field in the borrowed workspace, as server/work/budgeted_call.c does. */
static void use(struct fixture *fixture, struct server_loan *loan, uint32_t vertex)
{
    const struct gd_seed seed = {.point = vertex_point(fixture->mesh, vertex)};
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    const struct gd_control control = {.workspace = loan->workspace};
    struct gd_field *field = NULL;
    assert_int_equal(gd_field_build(fixture->mesh, &request, &control, NULL, &field, NULL), GD_OK);
    gd_field_release(field);
    size_t left = gd_workspace_bytes(loan->workspace);
    server_budget_adjust(&fixture->budget, SERVER_BUDGET_FLIGHT, loan->bytes, left);
    loan->bytes = left;
}

static size_t used(struct fixture *fixture, enum server_budget_class class)
{
    return atomic_load(&fixture->budget.used[class]);
}

static void what_a_call_leaves_is_there_for_the_next_and_counted(void **state)
{
    struct fixture *fixture = *state;
    struct server_loan loan = server_workspaces_borrow(fixture->workspaces);
    struct gd_workspace *first = loan.workspace;
    assert_int_equal(loan.bytes, 0);
    use(fixture, &loan, 0);
    size_t left = loan.bytes;
    assert_true(left > 10000);
    assert_int_equal(used(fixture, SERVER_BUDGET_FLIGHT), left);
    server_workspaces_return(fixture->workspaces, &loan);
    assert_null(loan.workspace);
    assert_int_equal(used(fixture, SERVER_BUDGET_FLIGHT), 0);
    assert_int_equal(used(fixture, SERVER_BUDGET_WORKSPACES), left);
    loan = server_workspaces_borrow(fixture->workspaces);
    assert_ptr_equal(loan.workspace, first);
    assert_int_equal(loan.bytes, left);
    assert_int_equal(used(fixture, SERVER_BUDGET_FLIGHT), left);
    assert_int_equal(used(fixture, SERVER_BUDGET_WORKSPACES), 0);
    server_workspaces_return(fixture->workspaces, &loan);
}

static void a_trimmed_one_stays_usable(void **state)
{
    struct fixture *fixture = *state;
    struct server_loan loan = server_workspaces_borrow(fixture->workspaces);
    use(fixture, &loan, 0);
    size_t before = loan.bytes;
    server_workspaces_trim(fixture->workspaces, &loan);
    assert_int_equal(fixture->budget.total, 0);
    assert_true(gd_workspace_bytes(loan.workspace) < 10000);
    use(fixture, &loan, 1);
    assert_true(loan.bytes <= before);
    server_workspaces_return(fixture->workspaces, &loan);
}

static void no_more_are_kept_than_there_are_workers(void **state)
{
    struct fixture *fixture = *state;
    struct server_loan loans[3];
    for (size_t i = 0; i < COUNT(loans); i++) {
        loans[i] = server_workspaces_borrow(fixture->workspaces);
        use(fixture, &loans[i], (uint32_t)i);
    }
    size_t each = loans[0].bytes;
    for (size_t i = 0; i < COUNT(loans); i++)
        server_workspaces_return(fixture->workspaces, &loans[i]);
    assert_true(used(fixture, SERVER_BUDGET_WORKSPACES) < 3 * each);
    assert_true(used(fixture, SERVER_BUDGET_WORKSPACES) > each);
    assert_int_equal(fixture->budget.total, used(fixture, SERVER_BUDGET_WORKSPACES));
}

static void under_pressure_idle_ones_go_first_and_borrowed_ones_stay(void **state)
{
    struct fixture *fixture = *state;
    struct server_loan idle = server_workspaces_borrow(fixture->workspaces);
    struct server_loan busy = server_workspaces_borrow(fixture->workspaces);
    use(fixture, &idle, 0);
    use(fixture, &busy, 1);
    size_t freed = idle.bytes, limit = fixture->budget.limit;
    server_workspaces_return(fixture->workspaces, &idle);
    assert_int_equal(server_budget_available(&fixture->budget), limit - busy.bytes);
    assert_true(
        server_budget_take(&fixture->budget, SERVER_BUDGET_MESHES, limit - busy.bytes - freed + 1));
    assert_int_equal(used(fixture, SERVER_BUDGET_WORKSPACES), 0);
    assert_int_equal(used(fixture, SERVER_BUDGET_FLIGHT), busy.bytes);
    assert_false(server_budget_take(&fixture->budget, SERVER_BUDGET_MESHES, freed));
    server_budget_give(&fixture->budget, SERVER_BUDGET_MESHES, limit - busy.bytes - freed + 1);
    use(fixture, &busy, 2);
    server_workspaces_return(fixture->workspaces, &busy);
}

#define ROUNDS 40

static void *borrow_and_build(void *user)
{
    struct fixture *fixture = user;
    for (uint32_t i = 0; i < ROUNDS; i++) {
        struct server_loan loan = server_workspaces_borrow(fixture->workspaces);
        use(fixture, &loan, i);
        if (i % 8 == 7) server_workspaces_trim(fixture->workspaces, &loan);
        server_workspaces_return(fixture->workspaces, &loan);
    }
    return NULL;
}

static void workers_and_reclaims_at_the_same_time(void **state)
{
    struct fixture *fixture = *state;
    const struct server_reclaimer *reclaimer =
        &fixture->budget.reclaimers[SERVER_RECLAIM_WORKSPACES];
    pthread_t threads[4];
    for (size_t i = 0; i < COUNT(threads); i++)
        assert_int_equal(pthread_create(&threads[i], NULL, borrow_and_build, fixture), 0);
    for (int i = 0; i < 20 * ROUNDS; i++) reclaimer->reclaim(reclaimer->user, i % 2 ? 1 : SIZE_MAX);
    for (size_t i = 0; i < COUNT(threads); i++) pthread_join(threads[i], NULL);
    assert_int_equal(used(fixture, SERVER_BUDGET_FLIGHT), 0);
    assert_int_equal(fixture->budget.total, used(fixture, SERVER_BUDGET_WORKSPACES));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_a_call_leaves_is_there_for_the_next_and_counted),
        TEST(a_trimmed_one_stays_usable),
        TEST(no_more_are_kept_than_there_are_workers),
        TEST(under_pressure_idle_ones_go_first_and_borrowed_ones_stay),
        TEST(workers_and_reclaims_at_the_same_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
