/* Tests jobs without a network. Jobs run exchanges by handlers and workers; the test defines the
 * handlers. */
#include "tests/unit/server/support.h"

#include <stdio.h>
#include <unistd.h>

#include "server/base/thread.h"
#include "server/exchange/events.h"
#include "server/jobs/job_table.h"
#include "server/exchange/reply.h"
#include "server/server.h"

#define SECOND UINT64_C(1000000000)

static struct server server;
static sem_t begun, hold; /* waiting work posts `begun` and waits for `hold` */
static size_t answer_size;
static atomic_int works;

static int start_server(uint64_t max_jobs, uint64_t ttl_s)
{
    memset(&server, 0, sizeof server);
    server.config = (struct server_config){
        .timeout_ms = 60000, .queue_length = 2, .job_ttl_s = ttl_s, .max_jobs = max_jobs};
    server_budget_init(&server.budget, 8 << 20);
    server.host.workers = server_workers_create(1, 2);
    server.api.cache = server_cache_create(&server.budget, server.host.workers);
    server.api.registry = server_registry_create(server_store_memory_create(), &server.budget);
    server.api.writer = server_workers_create(1, UINT32_MAX);
    server.api.lister = server_workers_create(1, UINT32_MAX);
    server.api.loader =
        server_loader_create(&(struct server_loader_parts){.workers = server.host.workers});
    server.host.events = server_events_create();
    server_connect(&server);
    assert_true(server_start_jobs(&server));
    sem_init(&begun, 0, 0);
    sem_init(&hold, 0, 0);
    answer_size = 100;
    works = 0;
    return 0;
}

static int set_up(void **state)
{
    (void)state;
    return start_server(4, 60);
}

static int set_up_small(void **state)
{
    (void)state;
    return start_server(2, 60);
}

static int set_up_short_lived(void **state)
{
    (void)state;
    return start_server(4, 0);
}

static int tear_down(void **state)
{
    (void)state;
    for (int i = 0; i < 100; i++) sem_post(&hold); /* releases the work of a failed test */
    server_workers_cancel(server.host.workers);
    while (atomic_load(&server.host.deferred)) usleep(1000);
    server_thread_stop(server.deadlines);
    server_job_table_destroy(server.api.jobs);
    server_events_destroy(server.host.events);
    server_surfaces_destroy(&server);
    server_workers_destroy(server.host.workers);
    server_workers_destroy(server.host.waiters);
    server_workers_destroy(server.host.batch_readers);
    assert_int_equal(server.budget.total, 0);
    return 0;
}

/* --- handlers --------------------------------------------------------------------------------- */

static void reply(struct server_exchange *exchange)
{
    server_reply_header(exchange, "ETag", "\"tag\"");
    server_reply_header(exchange, "Vary", "Accept");
    server_reply_bytes(exchange, 200, "application/json", calloc(1, answer_size), answer_size);
}

static void answer(struct server_exchange *exchange)
{
    reply(exchange);
}

static void answer_badly(struct server_exchange *exchange)
{
    server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND, "it is not there");
}

static bool wait_and_reply(struct server_exchange *exchange)
{
    works++;
    sem_post(&begun);
    sem_wait(&hold);
    reply(exchange);
    return true;
}

static void wait_in_a_worker(struct server_exchange *exchange)
{
    server_exchange_defer(exchange, wait_and_reply, NULL);
}

/* Reports progress, as the engine does, until it is stopped. */
static bool report_until_stopped(struct server_exchange *exchange)
{
    struct server_monitor monitor = {.exchange = exchange};
    struct gd_control control = server_exchange_control(&monitor);
    sem_post(&begun);
    while (gd_control_check(&control, 0.25) == GD_OK) usleep(1000);
    reply(exchange);
    return true;
}

static void go_on(struct server_exchange *exchange)
{
    server_exchange_defer(exchange, report_until_stopped, NULL);
}

/* Reports progress in two halves. The second half starts at 0 again. */
static bool report_in_parts(struct server_exchange *exchange)
{
    struct server_monitor halves[] = {{.exchange = exchange, .share = 0.5},
                                      {.exchange = exchange, .begun = 0.5, .share = 0.5}};
    static const double parts[] = {0, 0.8, 0.2, 1};
    for (size_t half = 0; half < 2; half++) {
        struct gd_control control = server_exchange_control(&halves[half]);
        for (size_t i = 0; i < COUNT(parts); i++) {
            assert_int_equal(gd_control_check(&control, parts[i]), GD_OK);
            sem_post(&begun);
            sem_wait(&hold);
        }
    }
    reply(exchange);
    return true;
}

static void report(struct server_exchange *exchange)
{
    server_exchange_defer(exchange, report_in_parts, NULL);
}

/* Makes progress within a limit on processor time, and then beyond a limit. */
static bool report_with_a_limit(struct server_exchange *exchange)
{
    struct server_monitor monitor = {.exchange = exchange, .cpu_limit_ns = UINT64_MAX};
    struct gd_control control = server_exchange_control(&monitor);
    assert_int_equal(gd_control_check(&control, 0.25), GD_OK);
    assert_false(monitor.is_over_limit);
    monitor.cpu_limit_ns = 1;
    assert_int_equal(gd_control_check(&control, 0.5), GD_CANCELLED);
    assert_true(monitor.is_over_limit);
    reply(exchange);
    return true;
}

static void report_limited(struct server_exchange *exchange)
{
    server_exchange_defer(exchange, report_with_a_limit, NULL);
}

/* Runs in the thread that starts the job. */
static void look_at_the_request(struct server_exchange *exchange)
{
    assert_string_equal(exchange->method, "POST");
    assert_string_equal(exchange->path, "/v1/meshes/cow/x");
    assert_ptr_equal(exchange->match.captures[0].text, exchange->path + 11);
    assert_int_equal(exchange->parameters.count, 1);
    assert_string_equal(exchange->parameters.all[0].name, "a");
    assert_string_equal(exchange->parameters.all[0].value, "b c");
    assert_string_equal(exchange->request_id, "id");
    assert_int_equal(exchange->header_count, 1);
    assert_string_equal(server_exchange_header(exchange, "content-type"), "text/plain");
    assert_int_equal(exchange->body.size, 4);
    assert_memory_equal(exchange->body.bytes, "body", 4);
    server_reply_empty(exchange, 204);
}

/* --- requests --------------------------------------------------------------------------------- */

static const char *tenant = ""; /* tenant of the next request */

static struct server_exchange *request(const struct proto_route *route)
{
    struct server_exchange *exchange =
        server_exchange_create(&server.host, NULL, "/v1/meshes/cow/x?a=b%20c");
    exchange->method = "POST";
    exchange->match = (struct proto_route_match){route, 1, {{exchange->path + 11, 3}}};
    exchange->tenant = tenant;
    return exchange;
}

static struct server_deferred_job *start_or_refuse(void (*handle)(struct server_exchange *exchange),
                                                   struct proto_problem *problem)
{
    const struct proto_route route = {.path = "/v1/meshes/{name}/x", .handle = handle};
    static struct proto_route routes[16]; /* static, because they must outlive the exchanges */
    static int next;
    struct proto_route *kept = &routes[next++ % 16];
    *kept = route;
    struct server_exchange *exchange = request(kept);
    struct server_deferred_job *job = server_job_table_start(server.api.jobs, exchange, problem);
    server_exchange_destroy(exchange);
    return job;
}

static struct server_deferred_job *start(void (*handle)(struct server_exchange *exchange))
{
    struct proto_problem problem;
    struct server_deferred_job *job = start_or_refuse(handle, &problem);
    assert_non_null(job);
    return job;
}

static enum proto_job_state state_of(struct server_deferred_job *job)
{
    return server_deferred_job_describe(job).state;
}

static void wait_for(struct server_deferred_job *job, enum proto_job_state state)
{
    for (int i = 0; i < 5000 && state_of(job) != state; i++) usleep(1000);
    assert_int_equal(state_of(job), state);
}

static bool is_there(const char *id)
{
    struct server_deferred_job *job =
        server_job_table_find(server.api.jobs, tenant, id, strlen(id));
    server_deferred_job_release(job);
    return job != NULL;
}

static size_t counted(void)
{
    return atomic_load(&server.budget.used[SERVER_BUDGET_JOBS]);
}

/* --- the tests -------------------------------------------------------------------------------- */

static void an_answer_is_kept_until_it_is_removed(void **state)
{
    (void)state;
    struct server_deferred_job *job = start(answer);
    struct proto_job told = server_deferred_job_describe(job);
    assert_int_equal(told.state, PROTO_JOB_DONE);
    assert_true(told.progress == 1);
    assert_string_equal(told.request, "POST /v1/meshes/cow/x");
    assert_int_equal(told.answer->status, 200);
    assert_int_equal(told.answer->size, 100);
    assert_int_equal(told.answer->header_count, 1); /* Vary is not saved */
    assert_string_equal(told.answer->headers[0].value, "\"tag\"");
    assert_int_equal(counted(), 100);
    assert_true(is_there(told.id));
    server_job_table_cancel(server.api.jobs, job);
    assert_false(is_there(told.id));
    /* as long as a reference exists, the bytes count as an unread answer */
    assert_int_equal(server_deferred_job_describe(job).answer->size, 100);
    assert_int_equal(counted(), 0);
    assert_int_equal(server.budget.used[SERVER_BUDGET_ANSWERS], 100);
    server_deferred_job_release(job);
    assert_int_equal(server.budget.used[SERVER_BUDGET_ANSWERS], 0);
}

static void a_problem_is_a_failure(void **state)
{
    (void)state;
    struct server_deferred_job *job = start(answer_badly);
    struct proto_job told = server_deferred_job_describe(job);
    assert_int_equal(told.state, PROTO_JOB_FAILED);
    assert_int_equal(told.answer->status, 404);
    assert_string_equal(told.answer->media_type, "application/problem+json");
    assert_true(told.progress == 0);
    server_deferred_job_release(job);
}

static void a_job_receives_the_whole_request(void **state)
{
    (void)state;
    const struct proto_route route = {.path = "/", .handle = look_at_the_request};
    struct server_exchange *exchange = request(&route);
    struct proto_problem problem;
    strcpy(exchange->request_id, "id");
    server_exchange_add_header(exchange, "Content-Type", "text/plain");
    assert_true(server_body_prepare(&exchange->body, &server.budget.common, 4, 10, &problem));
    server_body_append(&exchange->body, "body", 4);
    struct server_deferred_job *job = server_job_table_start(server.api.jobs, exchange, &problem);
    assert_int_equal(server_deferred_job_describe(job).answer->status, 204);
    assert_int_equal(exchange->body.size, 0);
    server_exchange_destroy(exchange);
    server_deferred_job_release(job);
}

static void states_follow_the_workers(void **state)
{
    (void)state;
    struct server_deferred_job *first = start(wait_in_a_worker);
    sem_wait(&begun);
    struct server_deferred_job *second = start(wait_in_a_worker);
    assert_int_equal(state_of(first), PROTO_JOB_RUNNING);
    assert_int_equal(state_of(second), PROTO_JOB_QUEUED);
    assert_null(server_deferred_job_describe(first).answer);
    sem_post(&hold);
    wait_for(first, PROTO_JOB_DONE);
    wait_for(second, PROTO_JOB_RUNNING);
    sem_post(&hold);
    wait_for(second, PROTO_JOB_DONE);
    struct server_job_statistics statistics = server_job_table_statistics(server.api.jobs, NULL);
    assert_int_equal(statistics.now[PROTO_JOB_DONE], 2);
    assert_int_equal(statistics.ended[PROTO_JOB_DONE], 2);
    server_deferred_job_release(first);
    server_deferred_job_release(second);
}

static void progress_never_falls(void **state)
{
    (void)state;
    static const double expected[] = {0, 0.4, 0.4, 0.5, 0.5, 0.9, 0.9, 1};
    struct server_deferred_job *job = start(report);
    for (size_t i = 0; i < COUNT(expected); i++) {
        sem_wait(&begun);
        assert_true(server_deferred_job_describe(job).progress == expected[i]);
        sem_post(&hold);
    }
    wait_for(job, PROTO_JOB_DONE);
    server_deferred_job_release(job);
}

static void a_call_ends_at_its_limit_of_processor_time(void **state)
{
    (void)state;
    struct server_deferred_job *job = start(report_limited);
    wait_for(job, PROTO_JOB_DONE);
    server_deferred_job_release(job);
}

static void a_waiting_job_is_cancelled_without_a_worker(void **state)
{
    (void)state;
    struct server_deferred_job *first = start(wait_in_a_worker);
    sem_wait(&begun);
    struct server_deferred_job *second = start(wait_in_a_worker);
    server_job_table_cancel(server.api.jobs, second);
    assert_int_equal(state_of(second), PROTO_JOB_CANCELLED);
    for (int i = 0; i < 5000 && atomic_load(&server.host.deferred) > 1; i++) usleep(1000);
    assert_int_equal(atomic_load(&server.host.deferred), 1); /* the job's exchange has ended */
    assert_true(is_there(server_deferred_job_describe(second).id)); /* the job still exists */
    server_job_table_cancel(server.api.jobs, second);
    assert_false(is_there(server_deferred_job_describe(second).id)); /* the job is removed */
    sem_post(&hold);
    wait_for(first, PROTO_JOB_DONE);
    assert_int_equal(works, 1);
    server_deferred_job_release(first);
    server_deferred_job_release(second);
}

static atomic_int waits_over;

static void note_end_of_wait(struct server_job *waiting)
{
    (void)waiting;
    waits_over++;
}

static void a_wait_ends_in_time_while_all_workers_are_busy(void **state)
{
    (void)state;
    struct server_job waiting = {.run = note_end_of_wait, .deadline_ns = UINT64_MAX};
    struct server_deferred_job *job = start(wait_in_a_worker);
    sem_wait(&begun);
    waits_over = 0;
    assert_true(server_deferred_job_wait(job, &waiting, gd_now_ns()));
    for (int i = 0; i < 5000 && !waits_over; i++) usleep(1000);
    assert_int_equal(waits_over, 1);
    assert_int_equal(state_of(job), PROTO_JOB_RUNNING);
    sem_post(&hold);
    wait_for(job, PROTO_JOB_DONE);
    server_deferred_job_release(job);
}

static void a_running_job_is_stopped_and_its_answer_dropped(void **state)
{
    (void)state;
    struct server_deferred_job *job = start(go_on);
    sem_wait(&begun);
    server_job_table_cancel(server.api.jobs, job);
    assert_int_equal(state_of(job), PROTO_JOB_CANCELLED);
    for (int i = 0; i < 5000 && atomic_load(&server.host.deferred); i++) usleep(1000);
    assert_int_equal(atomic_load(&server.host.deferred), 0);
    assert_int_equal(state_of(job), PROTO_JOB_CANCELLED);
    assert_null(server_deferred_job_describe(job).answer);
    assert_int_equal(counted(), 0);
    server_deferred_job_release(job);
}

static void ended_jobs_are_dropped_in_time(void **state)
{
    (void)state;
    struct server_deferred_job *running = start(wait_in_a_worker), *ended = start(answer);
    sem_wait(&begun);
    server_job_table_expire(server.api.jobs, gd_now_ns() + 59 * SECOND);
    assert_true(is_there(server_deferred_job_describe(ended).id));
    server_job_table_expire(server.api.jobs, gd_now_ns() + 61 * SECOND);
    assert_false(is_there(server_deferred_job_describe(ended).id));
    assert_true(is_there(server_deferred_job_describe(running).id));
    sem_post(&hold);
    server_deferred_job_release(running);
    server_deferred_job_release(ended);
}

static void an_expired_job_is_not_found(void **state)
{
    (void)state;
    struct server_deferred_job *job = start(answer), *listed[4];
    assert_false(is_there(server_deferred_job_describe(job).id));
    assert_int_equal(server_job_table_list(server.api.jobs, "", NULL, 4, listed), 0);
    server_deferred_job_release(job);
}

static void the_oldest_ended_job_makes_room(void **state)
{
    (void)state;
    struct server_deferred_job *running = start(wait_in_a_worker), *ended[4];
    sem_wait(&begun);
    for (int i = 0; i < 4; i++) ended[i] = start(answer);
    assert_true(is_there(server_deferred_job_describe(running).id));
    assert_false(is_there(server_deferred_job_describe(ended[0]).id));
    for (int i = 1; i < 4; i++) assert_true(is_there(server_deferred_job_describe(ended[i]).id));
    for (int i = 0; i < 4; i++) server_deferred_job_release(ended[i]);
    sem_post(&hold);
    server_deferred_job_release(running);
}

static void a_full_table_refuses(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct server_deferred_job *first = start(wait_in_a_worker), *second = start(wait_in_a_worker);
    assert_null(start_or_refuse(answer, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_OVERLOADED);
    assert_int_equal(problem.retry_after, 1);
    sem_post(&hold);
    sem_post(&hold);
    wait_for(second, PROTO_JOB_DONE);
    server_deferred_job_release(start(answer));
    server_deferred_job_release(first);
    server_deferred_job_release(second);
}

static struct server_deferred_job *start_for(const char *who)
{
    tenant = who;
    struct server_deferred_job *job = start(answer);
    tenant = "";
    return job;
}

static bool is_there_for(const char *who, struct server_deferred_job *job)
{
    tenant = who;
    bool found = is_there(server_deferred_job_describe(job).id);
    tenant = "";
    return found;
}

/* The table is full with four jobs. For a new job, the tenant with the most jobs loses its oldest
 * job. This may be the tenant of the new job. */
static void the_tenant_with_the_most_jobs_loses_one(void **state)
{
    (void)state;
    struct server_deferred_job *bob = start_for("bob"), *ann[6];
    for (int i = 0; i < 6; i++) ann[i] = start_for("ann");
    assert_true(is_there_for("bob", bob));
    for (int i = 0; i < 6; i++) assert_int_equal(is_there_for("ann", ann[i]), i >= 3);
    struct server_deferred_job *more = start_for("bob");
    assert_true(is_there_for("bob", bob) && is_there_for("bob", more) &&
                !is_there_for("ann", ann[3]));
    for (int i = 0; i < 6; i++) server_deferred_job_release(ann[i]);
    server_deferred_job_release(bob);
    server_deferred_job_release(more);
}

/* Runs a job whose answer has `bytes` bytes, and writes the job's id. All answers together may have
 * 1 MiB. Returns false if the job failed. */
static bool keep(const char *who, size_t bytes, char id[SERVER_JOB_ID])
{
    answer_size = bytes;
    struct server_deferred_job *job = start_for(who);
    bool is_kept = state_of(job) == PROTO_JOB_DONE;
    strcpy(id, server_deferred_job_describe(job).id);
    server_deferred_job_release(job);
    return is_kept;
}

static bool is_kept_for(const char *who, const char *id)
{
    tenant = who;
    bool found = is_there(id);
    tenant = "";
    return found;
}

static void a_large_answer_evicts_answers_of_its_tenant(void **state)
{
    (void)state;
    char bob[SERVER_JOB_ID], ann[3][SERVER_JOB_ID], refused[SERVER_JOB_ID];
    assert_true(keep("bob", 100 << 10, bob));
    for (int i = 0; i < 3; i++) assert_true(keep("ann", 400 << 10, ann[i]));
    assert_true(is_kept_for("bob", bob) && !is_kept_for("ann", ann[0]));
    assert_true(is_kept_for("ann", ann[1]) && is_kept_for("ann", ann[2]));
    /* with this answer bob's answers take the most memory */
    assert_false(keep("bob", 1000 << 10, refused));
    assert_true(is_kept_for("ann", ann[1]) && is_kept_for("ann", ann[2]));
}

static void answers_have_a_share_of_the_budget(void **state)
{
    (void)state;
    struct server_deferred_job *jobs[3];
    answer_size = 600 << 10; /* this is a part of the 1 MiB for all answers */
    for (int i = 0; i < 2; i++) {
        jobs[i] = start(answer);
        assert_int_equal(state_of(jobs[i]), PROTO_JOB_DONE);
        /* the first answer is dropped when the second job has ended */
        server_deferred_job_release(jobs[i]);
        assert_int_equal(counted(), answer_size);
    }
    answer_size = 2 << 20;
    jobs[2] = start(answer);
    assert_int_equal(server_deferred_job_describe(jobs[2]).answer->status, 507);
    server_deferred_job_release(jobs[2]);
}

static void jobs_are_listed_by_age(void **state)
{
    (void)state;
    struct server_deferred_job *jobs[4], *listed[4];
    for (int i = 0; i < 4; i++) jobs[i] = start(answer);
    for (int i = 0; i < 3; i++)
        assert_true(strcmp(server_deferred_job_describe(jobs[i]).id,
                           server_deferred_job_describe(jobs[i + 1]).id) < 0);
    assert_int_equal(server_job_table_list(server.api.jobs, "", NULL, 3, listed), 3);
    for (int i = 0; i < 3; i++) assert_ptr_equal(listed[i], jobs[i]);
    for (int i = 0; i < 3; i++) server_deferred_job_release(listed[i]);
    server_job_table_cancel(server.api.jobs, jobs[1]); /* a page may begin after a removed job */
    assert_int_equal(server_job_table_list(server.api.jobs, "",
                                           server_deferred_job_describe(jobs[1]).id, 4, listed),
                     2);
    assert_ptr_equal(listed[0], jobs[2]);
    assert_ptr_equal(listed[1], jobs[3]);
    for (int i = 0; i < 2; i++) server_deferred_job_release(listed[i]);
    assert_int_equal(server_job_table_list(server.api.jobs, "", "zzz", 4, listed), 0);
    for (int i = 0; i < 4; i++) server_deferred_job_release(jobs[i]);
}

static void jobs_are_visible_to_their_tenant_only(void **state)
{
    (void)state;
    struct server_deferred_job *listed[4];
    tenant = "a";
    struct server_deferred_job *job = start(answer);
    assert_true(is_there(server_deferred_job_describe(job).id));
    tenant = "";
    assert_false(is_there(server_deferred_job_describe(job).id));
    assert_int_equal(server_job_table_list(server.api.jobs, "", NULL, 4, listed), 0);
    assert_int_equal(server_job_table_list(server.api.jobs, "b", NULL, 4, listed), 0);
    assert_int_equal(server_job_table_list(server.api.jobs, "a", NULL, 4, listed), 1);
    server_deferred_job_release(listed[0]);
    server_deferred_job_release(job);
}

static void odd_ids_are_not_found(void **state)
{
    (void)state;
    server_deferred_job_release(start(answer));
    static const char *const ids[] = {"", "x", "000000000000000000000000",
                                      "ffffffffffffffffffffffff", "0000000000000000000000000"};
    for (size_t i = 0; i < COUNT(ids); i++) assert_false(is_there(ids[i]));
}

static void a_drain_refuses_waiting_jobs(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct server_deferred_job *running = start(wait_in_a_worker);
    sem_wait(&begun);
    struct server_deferred_job *queued = start(wait_in_a_worker);
    server_job_table_drain(server.api.jobs);
    wait_for(queued, PROTO_JOB_FAILED);
    assert_int_equal(server_deferred_job_describe(queued).answer->status, 503);
    assert_non_null(strstr(server_deferred_job_describe(queued).answer->body, "draining"));
    assert_int_equal(state_of(running), PROTO_JOB_RUNNING);
    assert_null(start_or_refuse(answer, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_DRAINING);
    sem_post(&hold);
    wait_for(running, PROTO_JOB_DONE);
    server_deferred_job_release(running);
    server_deferred_job_release(queued);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(an_answer_is_kept_until_it_is_removed),
        TEST(a_problem_is_a_failure),
        TEST(a_job_receives_the_whole_request),
        TEST(states_follow_the_workers),
        TEST(progress_never_falls),
        TEST(a_call_ends_at_its_limit_of_processor_time),
        TEST(a_waiting_job_is_cancelled_without_a_worker),
        TEST(a_wait_ends_in_time_while_all_workers_are_busy),
        TEST(a_running_job_is_stopped_and_its_answer_dropped),
        TEST(ended_jobs_are_dropped_in_time),
        cmocka_unit_test_setup_teardown(an_expired_job_is_not_found, set_up_short_lived, tear_down),
        TEST(the_oldest_ended_job_makes_room),
        cmocka_unit_test_setup_teardown(a_full_table_refuses, set_up_small, tear_down),
        TEST(answers_have_a_share_of_the_budget),
        TEST(the_tenant_with_the_most_jobs_loses_one),
        TEST(a_large_answer_evicts_answers_of_its_tenant),
        TEST(jobs_are_listed_by_age),
        TEST(jobs_are_visible_to_their_tenant_only),
        TEST(odd_ids_are_not_found),
        TEST(a_drain_refuses_waiting_jobs),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
