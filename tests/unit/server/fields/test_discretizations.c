/* Tests cached discretizations. They are found again, built once for all requests, evicted when
 * memory is short, and released with their surface. */
#include "tests/unit/server/support.h"

#include "server/server.h"

#define LEVEL 5

static struct server server;
static struct server_exchange exchange;
static struct gd_subdivision *surface;
static struct server_discretization_slot slots[3];

static bool never_gone(struct server_exchange *of)
{
    (void)of;
    return false;
}

static struct gd_subdivision *new_sheet(void)
{
    static double positions[4][3] = {{0, 0, 0}, {2, 0, 0.5}, {2, 1, 0}, {0, 1, 0.25}};
    static uint32_t corners[] = {0, 1, 2, 3}, first[] = {0, 4};
    const struct gd_control_mesh mesh = {.polygons = {.positions = positions,
                                                      .position_count = 4,
                                                      .polygon_count = 1,
                                                      .corners = corners,
                                                      .first = first}};
    struct gd_subdivision *made = NULL;
    assert_int_equal(gd_subdivision_create(&mesh, GD_SCHEME_CATMULL_CLARK, NULL, &made, NULL),
                     GD_OK);
    return made;
}

static int set_up(void **state)
{
    static const struct server_transport transport = {.is_gone = never_gone};
    (void)state;
    memset(&server, 0, sizeof server);
    memset(&exchange, 0, sizeof exchange);
    memset(slots, 0, sizeof slots);
    server.config.max_faces = 1000000;
    exchange.host = &server.host;
    exchange.transport = &transport;
    exchange.job.deadline_ns = gd_now_ns() + UINT64_C(60000000000);
    surface = new_sheet();
    size_t cost = gd_limit_mesh_cost(surface, LEVEL);
    server_budget_init(&server.budget, cost + cost / 2);
    server.host.workspaces = server_workspaces_create(&server.budget, 1);
    server.host.workers = server_workers_create(1, 1);
    server.api.discretizations = server_discretizations_create(server.host.workspaces, 1000000);
    server_connect(&server);
    return server.api.discretizations ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(slots); i++) server_discretization_slot_close(&slots[i]);
    server_discretizations_destroy(server.api.discretizations);
    server_workers_destroy(server.host.workers);
    server_workspaces_destroy(server.host.workspaces);
    gd_subdivision_release(surface);
    assert_int_equal(atomic_load(&server.budget.total), 0);
    return 0;
}

static size_t counted(void)
{
    return atomic_load(&server.budget.used[SERVER_BUDGET_DISCRETIZATIONS]);
}

static enum gd_status get(size_t slot, uint32_t level, struct server_discretization **out)
{
    struct server_monitor monitor = {.exchange = &exchange};
    struct gd_detail detail = {0};
    const struct server_discretization_request request = {.slot = &slots[slot],
                                                          .surface = surface,
                                                          .level = level,
                                                          .control =
                                                              server_exchange_control(&monitor),
                                                          .detail = &detail};
    return server_discretizations_get(server.api.discretizations, &request, out);
}

static void a_level_is_kept_and_found_again(void **state)
{
    (void)state;
    struct server_discretization *first, *second, *other;
    assert_int_equal(get(0, 3, &first), GD_OK);
    assert_int_equal(counted(), gd_limit_mesh_memsize(first->mesh));
    assert_int_equal(get(0, 3, &second), GD_OK);
    assert_ptr_equal(first, second);
    assert_int_equal(get(0, 2, &other), GD_OK);
    assert_int_equal(gd_limit_mesh_level(other->mesh), 2);
    assert_int_equal(counted(), first->item.bytes + other->item.bytes);
    server_discretization_release(first);
    server_discretization_release(other);
    server_discretization_slot_close(&slots[0]);
    assert_int_equal(counted(), second->item.bytes); /* still in use */
    server_discretization_release(second);
    assert_int_equal(counted(), 0);
}

static void *ask(void *out)
{
    return get(0, LEVEL, out) == GD_OK ? out : NULL;
}

static void concurrent_requests_share_one_build(void **state)
{
    (void)state;
    struct server_discretization *found[4];
    pthread_t threads[4];
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, ask, &found[i]), 0);
    for (size_t i = 0; i < 4; i++) {
        void *result;
        pthread_join(threads[i], &result);
        assert_ptr_equal(result, &found[i]);
        assert_ptr_equal(found[i], found[0]);
    }
    assert_int_equal(counted(), found[0]->item.bytes);
    for (size_t i = 0; i < 4; i++) server_discretization_release(found[i]);
}

/* The budget has room only for one build and the result of another build. */
static void the_least_recently_used_is_evicted(void **state)
{
    (void)state;
    struct server_discretization *found;
    for (size_t slot = 0; slot < 2; slot++) {
        assert_int_equal(get(slot, LEVEL - 1, &found), GD_OK);
        server_discretization_release(found);
    }
    assert_int_equal(get(0, LEVEL - 1, &found), GD_OK); /* used again */
    server_discretization_release(found);
    assert_non_null(slots[1].levels[LEVEL - 1]);
    size_t most = server.budget.limit - counted() + 1;
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, most));
    assert_null(slots[1].levels[LEVEL - 1]);
    assert_non_null(slots[0].levels[LEVEL - 1]);
    server_budget_give(&server.budget, SERVER_BUDGET_FLIGHT, most);
}

static void failures_leak_nothing(void **state)
{
    (void)state;
    struct server_discretization *found = NULL;
    assert_int_equal(get(0, 8, &found), GD_BUDGET);
    assert_int_equal(get(0, 12, &found), GD_TOO_LARGE);
    exchange.job.deadline_ns = 1;
    assert_int_equal(get(0, LEVEL, &found), GD_DEADLINE);
    assert_null(found);
    assert_false(slots[0].is_building[LEVEL]);
    exchange.job.deadline_ns = gd_now_ns() + UINT64_C(60000000000);
    assert_int_equal(get(0, LEVEL, &found), GD_OK);
    server_discretization_release(found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_level_is_kept_and_found_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(concurrent_requests_share_one_build, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_least_recently_used_is_evicted, set_up, tear_down),
        cmocka_unit_test_setup_teardown(failures_leak_nothing, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
