/* Tests exchanges in router, handlers and workers without a network. */
#include "tests/unit/server/daemon.h"

static int set_up(void **state)
{
    (void)state;
    daemon_start(server_store_memory_create());
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    daemon_stop();
    return 0;
}

static struct server_exchange *exchange_of(const char *method, const char *target,
                                           const char *headers, const char *body)
{
    return daemon_ask((struct daemon_request){
        .method = method, .target = target, .headers = headers, .body = body});
}

static unsigned status_of(const char *method, const char *target, const char *headers,
                          const char *body)
{
    return daemon_status((struct daemon_request){
        .method = method, .target = target, .headers = headers, .body = body});
}

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

#define PUT_SQUARE() status_of("PUT", "/v1/meshes/square", "", square)

static void an_upload_and_a_query(void **state)
{
    (void)state;
    assert_int_equal(PUT_SQUARE(), 201);
    assert_int_equal(PUT_SQUARE(), 200);
    struct server_exchange *exchange = exchange_of(
        "GET", "/v1/meshes/square/distance?from=v:0&to=v%3a1&select=distance", "", NULL);
    assert_int_equal(exchange->response.status, 200);
    assert_int_equal(exchange->response.size, strlen("{\"distance\":1}"));
    assert_memory_equal(exchange->response.body, "{\"distance\":1}", exchange->response.size);
    assert_ptr_not_equal(exchange->work, NULL); /* answered by a worker */
    server_exchange_destroy(exchange);
    for (int i = 1; i < SERVER_CACHE_SEARCHES; i++)
        assert_int_equal(status_of("GET", "/v1/meshes/square/distance?from=v:0&to=v:1", "", NULL),
                         200);
    exchange = exchange_of("GET", "/v1/meshes/square/distance?from=v:2&to=v:0", "", NULL);
    /* the request is answered at once, because v:0 has a field now */
    assert_ptr_equal(exchange->work, NULL);
    server_exchange_destroy(exchange);
    assert_int_equal(status_of("DELETE", "/v1/meshes/square", "", NULL), 204);
    assert_int_equal(status_of("GET", "/v1/meshes/square", "", NULL), 404);
}

static void requests_that_permit_it_become_jobs(void **state)
{
    (void)state;
    static const char prefer[] = "Prefer: respond-async";
    assert_int_equal(status_of("PUT", "/v1/meshes/square", prefer, square), 202);
    while (server_registry_statistics(daemon_server.api.registry).surfaces == 0) usleep(1000);
    struct server_exchange *exchange =
        exchange_of("GET", "/v1/meshes/square/nearest?point=v:1", "Prefer: respond-async", NULL);
    assert_int_equal(exchange->response.status, 202);
    assert_string_equal(daemon_header(exchange, "Preference-Applied"), "respond-async");
    const char *location = daemon_header(exchange, "Location");
    assert_int_equal(status_of("GET", location, "", NULL), 200);
    server_exchange_destroy(exchange);
    assert_int_equal(status_of("GET", "/v1/meshes", "Prefer: respond-async", NULL), 200);
    /* an invalid name is refused with or without Prefer */
    assert_int_equal(status_of("PUT", "/v1/meshes/-/..", prefer, square), 404);
}

static void a_number_may_hold_a_plus_sign(void **state)
{
    (void)state;
    assert_int_equal(PUT_SQUARE(), 201);
    assert_int_equal(
        status_of("GET", "/v1/meshes/square/nearest?point=p:5e-1,2.5e+0,1e+2", "", NULL), 200);
}

static void malformed_targets_are_refused(void **state)
{
    (void)state;
    static const char *const targets[] = {"/v1/%",   "/v1/%4",       "/v1/%zz",
                                          "/v1/%00", "/v1%2fmeshes", "/v1%2Fmeshes",
                                          "/v1/%0a", "/v1?a=%",      "/v1?%00"};
    for (size_t i = 0; i < COUNT(targets); i++)
        assert_int_equal(status_of("GET", targets[i], "", NULL), 400);
    assert_int_equal(status_of("GET", "*", "", NULL), 404);
    assert_int_equal(status_of("GET", "", "", NULL), 404);
}

static void a_refusal_before_the_body_closes_the_connection(void **state)
{
    (void)state;
    char wrong[] = "Content-Length: 48", fine[] = "Content-Length: 48",
         twice[] = "Content-Length: 0\nContent-Length: 0", none[] = "";
    struct server_exchange *exchange = daemon_begin("PUT", "/v1/nothing", wrong);
    assert_int_equal(exchange->response.status, 404);
    assert_true(exchange->response.close);
    server_exchange_destroy(exchange);
    exchange = daemon_begin("PUT", "/v1/meshes/a", fine);
    assert_int_equal(exchange->response.status, 0);
    assert_false(exchange->response.close);
    server_exchange_destroy(exchange);
    exchange = daemon_begin("PUT", "/v1/meshes/a", twice);
    assert_int_equal(exchange->response.status, 400);
    assert_true(exchange->response.close);
    server_exchange_destroy(exchange);
    exchange = daemon_begin("GET", "/v1/nothing", none);
    assert_int_equal(exchange->response.status, 404);
    assert_false(exchange->response.close);
    server_exchange_destroy(exchange);
}

static void a_request_gets_an_id(void **state)
{
    (void)state;
    struct server_exchange *exchange = exchange_of("GET", "/v1", "X-Request-Id: a.B-9_", NULL);
    assert_string_equal(daemon_header(exchange, "X-Request-Id"), "a.B-9_");
    server_exchange_destroy(exchange);
    struct server_exchange *a = exchange_of("GET", "/v1", "X-Request-Id: a b", NULL),
                           *b = exchange_of("GET", "/v1", "", NULL);
    assert_string_not_equal(a->request_id, "a b");
    assert_string_not_equal(a->request_id, b->request_id);
    server_exchange_destroy(a);
    server_exchange_destroy(b);
}

static void options_list_the_methods(void **state)
{
    (void)state;
    struct server_exchange *exchange = exchange_of("OPTIONS", "/v1/meshes", "", NULL);
    assert_int_equal(exchange->response.status, 204);
    assert_string_equal(daemon_header(exchange, "Allow"), "GET, HEAD, POST, OPTIONS");
    server_exchange_destroy(exchange);
}

static void long_answers_are_compressed_if_accepted(void **state)
{
    (void)state;
    static const struct {
        const char *accept;
        bool compressed;
    } cases[] = {{"", false},
                 {"Accept-Encoding: gzip", true},
                 {"Accept-Encoding: br, GZIP;q=0.5", true},
                 {"Accept-Encoding: gzip;q=0", false},
                 {"Accept-Encoding: gzip;q=0.0, br", false},
                 {"Accept-Encoding: gzip;q=0.001", true},
                 {"Accept-Encoding: gzip, br;q=0", true},
                 {"Accept-Encoding: identity", false}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct server_exchange *exchange = exchange_of("GET", "/metrics", cases[i].accept, NULL);
        assert_int_equal(daemon_header(exchange, "Content-Encoding") != NULL, cases[i].compressed);
        assert_string_equal(daemon_header(exchange, "Vary"), "Accept-Encoding");
        const unsigned char *body = exchange->response.body;
        assert_int_equal(body[0] == 0x1f && body[1] == 0x8b, cases[i].compressed);
        server_exchange_destroy(exchange);
    }
    struct server_exchange *small = exchange_of("GET", "/livez", "Accept-Encoding: gzip", NULL);
    assert_null(daemon_header(small, "Content-Encoding"));
    server_exchange_destroy(small);
}

static void a_drain_closes_connections(void **state)
{
    (void)state;
    atomic_store(&daemon_server.host.is_draining, true);
    struct server_exchange *exchange = exchange_of("GET", "/readyz", "", NULL);
    assert_int_equal(exchange->response.status, 503);
    assert_true(exchange->response.close);
    assert_string_equal(daemon_header(exchange, "Retry-After"), "1");
    server_exchange_destroy(exchange);
    assert_int_equal(status_of("GET", "/livez", "", NULL), 200);
}

static void work_after_the_cancel_is_refused(void **state)
{
    (void)state;
    assert_int_equal(PUT_SQUARE(), 201);
    server_workers_cancel(daemon_server.host.workers);
    struct server_exchange *exchange =
        exchange_of("GET", "/v1/meshes/square/distance?from=v:0&to=v:1", "", NULL);
    assert_int_equal(exchange->response.status, 503);
    assert_int_equal(exchange->response.problem, PROTO_PROBLEM_DRAINING);
    server_exchange_destroy(exchange);
}

static size_t counted(enum server_budget_class class)
{
    return atomic_load(&daemon_server.budget.used[class]);
}

static void a_search_leaves_a_workspace_that_is_counted(void **state)
{
    (void)state;
    assert_int_equal(PUT_SQUARE(), 201);
    assert_int_equal(counted(SERVER_BUDGET_WORKSPACES), 0);
    assert_int_equal(status_of("GET", "/v1/meshes/square/distance?from=v:0&to=v:1", "", NULL), 200);
    size_t left = counted(SERVER_BUDGET_WORKSPACES);
    assert_true(left > 0);
    assert_int_equal(status_of("GET", "/v1/meshes/square/distance?from=v:2&to=v:3", "", NULL), 200);
    assert_in_range(counted(SERVER_BUDGET_WORKSPACES), left, 2 * left);
    assert_int_equal(counted(SERVER_BUDGET_FLIGHT), 0);
}

/* The first grant exceeds the free memory. The budget therefore frees the idle workspace, and the
 * call gets all remaining memory. */
static void a_search_can_use_all_memory(void **state)
{
    (void)state;
    assert_int_equal(PUT_SQUARE(), 201);
    assert_int_equal(status_of("GET", "/v1/meshes/square/distance?from=v:0&to=v:1", "", NULL), 200);
    /* half of the budget is too little for a search */
    size_t left = counted(SERVER_BUDGET_WORKSPACES);
    size_t taken = daemon_server.budget.limit - counted(SERVER_BUDGET_MESHES) - left - left / 2;
    assert_true(server_budget_take(&daemon_server.budget, SERVER_BUDGET_FLIGHT, taken));
    unsigned status = status_of("GET", "/v1/meshes/square/distance?from=v:2&to=v:3", "", NULL);
    assert_int_equal(counted(SERVER_BUDGET_FLIGHT), taken);
    server_budget_give(&daemon_server.budget, SERVER_BUDGET_FLIGHT, taken);
    assert_int_equal(status, 200);
}

/* Asserts the answer to a job that is refused for the reason `why` while it waits. */
static void assert_told(enum server_refusal why, unsigned status, const char *words)
{
    char none[] = "";
    struct server_exchange *exchange = daemon_begin("GET", "/v1", none);
    server_exchange_count_deferred(&daemon_server.host);
    exchange->response.status = 0;
    exchange->job.refuse(&exchange->job, why);
    sem_wait(&daemon_finished);
    char *body = strndup(exchange->response.body, exchange->response.size);
    assert_int_equal(exchange->response.status, status);
    assert_non_null(strstr(body, words));
    free(body);
    server_exchange_destroy(exchange);
}

static void a_refused_job_gets_the_reason(void **state)
{
    (void)state;
    assert_told(SERVER_REFUSAL_DEADLINE, 504, "deadline");
    assert_told(SERVER_REFUSAL_DRAINING, 503, "draining");
    assert_told(SERVER_REFUSAL_MEMORY, 507, "--memory-budget");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(an_upload_and_a_query),
        TEST(requests_that_permit_it_become_jobs),
        TEST(a_number_may_hold_a_plus_sign),
        TEST(malformed_targets_are_refused),
        TEST(a_refusal_before_the_body_closes_the_connection),
        TEST(a_request_gets_an_id),
        TEST(options_list_the_methods),
        TEST(long_answers_are_compressed_if_accepted),
        TEST(a_drain_closes_connections),
        TEST(work_after_the_cancel_is_refused),
        TEST(a_search_leaves_a_workspace_that_is_counted),
        TEST(a_search_can_use_all_memory),
        TEST(a_refused_job_gets_the_reason),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
