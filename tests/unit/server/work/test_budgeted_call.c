/* Tests calls of the engine within the memory budget: their grants, the bytes that are counted
 * afterwards, and the workspaces that they reuse. */
#include "tests/unit/server/support.h"

#include "server/work/budgeted_call.h"

#define MIB ((size_t)1 << 20)

static struct fixture {
    struct server_budget budget;
    struct server_workspaces *workspaces;
    struct gd_mesh *mesh;
} fixture;
static int walks;

static size_t walk(void *user)
{
    (void)user;
    walks++;
    return 0;
}

static int set_up_with(size_t limit)
{
    memset(&fixture, 0, sizeof fixture);
    server_budget_init(&fixture.budget, limit);
    fixture.budget.reclaimers[SERVER_RECLAIM_MESHES] = (struct server_reclaimer){NULL, walk, NULL};
    fixture.workspaces = server_workspaces_create(&fixture.budget, 2);
    fixture.mesh = new_mesh();
    walks = 0;
    return 0;
}

static int set_up(void **state)
{
    (void)state;
    return set_up_with(1 * MIB);
}

static int set_up_large(void **state)
{
    (void)state;
    return set_up_with(1024 * MIB);
}

static int tear_down(void **state)
{
    (void)state;
    server_workspaces_destroy(fixture.workspaces);
    assert_int_equal(fixture.budget.used[SERVER_BUDGET_WORKSPACES], 0);
    gd_mesh_release(fixture.mesh);
    return 0;
}

static size_t used(enum server_budget_class class)
{
    return atomic_load(&fixture.budget.used[class]);
}

/* --- grants ----------------------------------------------------------------------------------- */

/* A call that needs `need` bytes and keeps `keep` of these bytes. */
struct task {
    size_t need, keep;
    size_t grants[8];
    int attempts;
};

static enum gd_status attempt(struct task *task, const struct gd_control *control, size_t *kept)
{
    task->grants[task->attempts++] = control->budget_bytes;
    if (control->budget_bytes < task->need) return GD_BUDGET;
    *kept = task->keep;
    return GD_OK;
}

static enum gd_status call(struct task *task, size_t grant)
{
    struct server_budgeted_call call = {.workspaces = fixture.workspaces, .grant = grant};
    while (server_budgeted_call_next(&call)) call.status = attempt(task, &call.control, &call.kept);
    return call.status;
}

static void a_sufficient_grant_walks_no_meshes(void **state)
{
    (void)state;
    struct task task = {.need = 1000, .keep = 100};
    assert_int_equal(call(&task, 1000), GD_OK);
    assert_int_equal(task.attempts, 1);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 100);
    assert_int_equal(walks, 0);
}

static void a_failed_call_runs_again_with_more(void **state)
{
    (void)state;
    struct task task = {.need = 10000};
    assert_int_equal(call(&task, 1000), GD_OK);
    assert_int_equal(task.attempts, 3);
    assert_int_equal(task.grants[2], 16000);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
}

static void the_last_attempt_gets_all_available_memory(void **state)
{
    (void)state;
    struct task fits = {.need = 900000}, does_not_fit = {.need = MIB + 1};
    assert_int_equal(call(&fits, 100000), GD_OK);
    assert_int_equal(call(&does_not_fit, 100000), GD_BUDGET);
    assert_int_equal(does_not_fit.attempts, 3);
    assert_int_equal(does_not_fit.grants[2], server_budget_available(&fixture.budget));
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
}

static void no_call_starts_without_memory(void **state)
{
    (void)state;
    struct task task = {.need = 1};
    assert_true(server_budget_take(&fixture.budget, SERVER_BUDGET_FLIGHT, fixture.budget.limit));
    assert_int_equal(call(&task, 1000), GD_BUDGET);
    assert_int_equal(task.attempts, 0);
}

static void the_last_attempt_leaves_memory_for_other_allocations(void **state)
{
    (void)state;
    struct server_budgeted_call call = {
        .workspaces = fixture.workspaces, .grant = 2 * MIB, .aside = 1000};
    size_t granted = 0;
    while (server_budgeted_call_next(&call)) granted = call.control.budget_bytes;
    assert_int_equal(call.status, GD_OK);
    assert_int_equal(granted, MIB - 1000);
}

struct rival {
    sem_t has_begun, may_end;
};

static void *hold_all(void *user)
{
    struct rival *rival = user;
    struct server_budgeted_call call = {.workspaces = fixture.workspaces, .grant = MIB};
    while (server_budgeted_call_next(&call)) {
        sem_post(&rival->has_begun);
        sem_wait(&rival->may_end);
    }
    return NULL;
}

/* Lets the rival end when the waiting call checks its control. */
static bool end_rival(void *user, double fraction)
{
    (void)fraction;
    sem_post(&((struct rival *)user)->may_end);
    return true;
}

static bool refuse(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}

static enum gd_status call_beside_rival(bool (*progress)(void *user, double fraction))
{
    struct rival rival;
    pthread_t thread;
    sem_init(&rival.has_begun, 0, 0);
    sem_init(&rival.may_end, 0, 0);
    assert_int_equal(pthread_create(&thread, NULL, hold_all, &rival), 0);
    sem_wait(&rival.has_begun);
    struct server_budgeted_call call = {.workspaces = fixture.workspaces,
                                        .grant = 1000,
                                        .control = {.progress = progress, .user = &rival}};
    struct task task = {.need = 1000};
    while (server_budgeted_call_next(&call))
        call.status = attempt(&task, &call.control, &call.kept);
    sem_post(&rival.may_end);
    pthread_join(thread, NULL);
    sem_destroy(&rival.has_begun);
    sem_destroy(&rival.may_end);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
    return call.status;
}

static void a_call_waits_for_memory_that_others_hold(void **state)
{
    (void)state;
    assert_int_equal(call_beside_rival(end_rival), GD_OK);
}

static void a_waiting_call_can_be_cancelled(void **state)
{
    (void)state;
    assert_int_equal(call_beside_rival(refuse), GD_CANCELLED);
}

/* --- workspaces ------------------------------------------------------------------------------- */

/* A call that builds a field, then makes `inner` nested calls, and then calls `within`. */
struct building {
    uint32_t vertex, inner;
    void (*within)(const struct building *building);
    const struct gd_workspace *workspace; /* the workspace that the call received */
    size_t before, after;                 /* sizes of the workspace in bytes */
};

static void build(struct building *building);

static void build_field(struct building *building, const struct gd_control *control)
{
    const struct gd_seed seed = {.point = vertex_point(fixture.mesh, building->vertex)};
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_field *field = NULL;
    building->workspace = control->workspace;
    building->before = gd_workspace_bytes(control->workspace);
    assert_int_equal(gd_field_build(fixture.mesh, &request, control, &field, NULL), GD_OK);
    gd_field_release(field);
    building->after = gd_workspace_bytes(control->workspace);
    if (building->inner) build(&(struct building){.vertex = 1, .inner = building->inner - 1});
    if (building->within) building->within(building);
}

static void build(struct building *building)
{
    struct server_budgeted_call call = {.workspaces = fixture.workspaces, .grant = MIB};
    while (server_budgeted_call_next(&call)) build_field(building, &call.control);
    assert_int_equal(call.status, GD_OK);
}

static void the_next_call_reuses_the_memory_of_a_call(void **state)
{
    (void)state;
    struct building first = {.vertex = 0}, second = {.vertex = 1};
    build(&first);
    assert_true(first.after > 10000);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
    assert_int_equal(used(SERVER_BUDGET_WORKSPACES), first.after);
    build(&second);
    assert_ptr_equal(second.workspace, first.workspace);
    assert_int_equal(second.before, first.after);
    assert_int_equal(used(SERVER_BUDGET_WORKSPACES), second.after);
}

static void a_call_that_needs_the_memory_trims_its_workspace(void **state)
{
    (void)state;
    struct building first = {.vertex = 0}, second = {.vertex = 1};
    build(&first);
    size_t taken = fixture.budget.limit - MIB - first.after / 2;
    assert_true(server_budget_take(&fixture.budget, SERVER_BUDGET_MESHES, taken));
    build(&second);
    assert_ptr_equal(second.workspace, first.workspace);
    assert_true(second.before < 10000);
    server_budget_give(&fixture.budget, SERVER_BUDGET_MESHES, taken);
}

static void at_most_two_idle_workspaces_are_kept(void **state)
{
    (void)state;
    struct building building = {.inner = 2};
    build(&building);
    assert_true(used(SERVER_BUDGET_WORKSPACES) < 3 * building.after);
    assert_true(used(SERVER_BUDGET_WORKSPACES) > building.after);
    assert_int_equal(fixture.budget.total, used(SERVER_BUDGET_WORKSPACES));
}

/* Runs while one workspace is in use and another one is idle. */
static void take_almost_all(const struct building *building)
{
    size_t idle = used(SERVER_BUDGET_WORKSPACES), free_bytes = fixture.budget.limit - MIB;
    assert_true(idle > 0);
    assert_true(server_budget_take(&fixture.budget, SERVER_BUDGET_MESHES, free_bytes));
    assert_int_equal(used(SERVER_BUDGET_WORKSPACES), 0);
    assert_int_equal(gd_workspace_bytes(building->workspace), building->after);
    server_budget_give(&fixture.budget, SERVER_BUDGET_MESHES, free_bytes);
}

static void only_idle_workspaces_are_reclaimed(void **state)
{
    (void)state;
    struct building building = {.inner = 1, .within = take_almost_all};
    build(&building);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
}

#define ROUNDS 40

static void *build_often(void *user)
{
    (void)user;
    for (uint32_t i = 0; i < ROUNDS; i++) build(&(struct building){.vertex = i});
    return NULL;
}

static void calls_and_reclaims_run_at_the_same_time(void **state)
{
    (void)state;
    const struct server_reclaimer *reclaimer =
        &fixture.budget.reclaimers[SERVER_RECLAIM_WORKSPACES];
    pthread_t threads[4];
    for (size_t i = 0; i < COUNT(threads); i++)
        assert_int_equal(pthread_create(&threads[i], NULL, build_often, NULL), 0);
    for (int i = 0; i < 20 * ROUNDS; i++) reclaimer->reclaim(reclaimer->user, i % 2 ? 1 : SIZE_MAX);
    for (size_t i = 0; i < COUNT(threads); i++) pthread_join(threads[i], NULL);
    assert_int_equal(used(SERVER_BUDGET_FLIGHT), 0);
    assert_int_equal(fixture.budget.total, used(SERVER_BUDGET_WORKSPACES));
}

int main(void)
{
#define SMALL(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
#define LARGE(name) cmocka_unit_test_setup_teardown(name, set_up_large, tear_down)
    const struct CMUnitTest tests[] = {
        SMALL(a_sufficient_grant_walks_no_meshes),
        SMALL(a_failed_call_runs_again_with_more),
        SMALL(the_last_attempt_gets_all_available_memory),
        SMALL(no_call_starts_without_memory),
        SMALL(the_last_attempt_leaves_memory_for_other_allocations),
        SMALL(a_call_waits_for_memory_that_others_hold),
        SMALL(a_waiting_call_can_be_cancelled),
        LARGE(the_next_call_reuses_the_memory_of_a_call),
        LARGE(a_call_that_needs_the_memory_trims_its_workspace),
        LARGE(at_most_two_idle_workspaces_are_kept),
        LARGE(only_idle_workspaces_are_reclaimed),
        LARGE(calls_and_reclaims_run_at_the_same_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
