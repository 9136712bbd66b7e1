#include "tests/unit/server/support.h"

#include <pthread.h>

#include "server/access/credentials.h"

#define SECOND UINT64_C(1000000000)

static struct server_quota *quota;

static int set_up(void **state)
{
    (void)state;
    quota = server_quota_create();
    return quota ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    server_quota_release(quota);
    return 0;
}

/* Sends `count` requests, one in each `interval`, beginning at `*now`. Each admitted request ends
 * at once. Returns the number of admitted requests. */
static int let_in(const struct server_limits *limits, int count, uint64_t interval, uint64_t *now)
{
    int entered = 0;
    for (int i = 0; i < count; i++, *now += interval) {
        uint64_t wait_ns;
        if (server_quota_enter(quota, limits, *now, &wait_ns) != SERVER_QUOTA_ENTERED) continue;
        server_quota_leave(quota);
        entered++;
    }
    return entered;
}

static void a_burst_is_as_large_as_the_rate(void **state)
{
    (void)state;
    static const uint32_t rates[] = {1, 2, 3, 7, 100, 999983, SERVER_LIMITS_MOST};
    for (size_t i = 0; i < COUNT(rates); i++) {
        const struct server_limits limits = {.rate = rates[i]};
        uint64_t now = SECOND * 1000 * (i + 1);
        assert_int_equal(let_in(&limits, (int)rates[i] + 10, 0, &now), rates[i]);
        now += SECOND; /* the bucket is full again */
        assert_int_equal(let_in(&limits, (int)rates[i] + 10, 0, &now), rates[i]);
    }
}

static void the_average_rate_is_kept(void **state)
{
    (void)state;
    const struct server_limits limits = {.rate = 50};
    uint64_t now = SECOND;
    /* sends a thousand requests a second for ten seconds */
    int entered = let_in(&limits, 10000, SECOND / 1000, &now);
    assert_in_range(entered, 50 * 10, 50 * 11);
}

static void a_client_that_waits_for_retry_after_is_admitted(void **state)
{
    (void)state;
    const struct server_limits limits = {.rate = 3};
    uint64_t now = SECOND, wait_ns;
    assert_int_equal(let_in(&limits, 3, 0, &now), 3);
    assert_int_equal(server_quota_enter(quota, &limits, now, &wait_ns), SERVER_QUOTA_RATE);
    assert_in_range(wait_ns, 1, SECOND / 3);
    uint64_t told = wait_ns;
    assert_int_equal(server_quota_enter(quota, &limits, now + told - 1, &wait_ns),
                     SERVER_QUOTA_RATE);
    assert_int_equal(server_quota_enter(quota, &limits, now + told, &wait_ns),
                     SERVER_QUOTA_ENTERED);
}

static void concurrent_requests_are_limited(void **state)
{
    (void)state;
    const struct server_limits limits = {.concurrent = 2};
    uint64_t wait_ns = 1;
    for (int i = 0; i < 2; i++)
        assert_int_equal(server_quota_enter(quota, &limits, 1, &wait_ns), SERVER_QUOTA_ENTERED);
    assert_int_equal(server_quota_enter(quota, &limits, 1, &wait_ns), SERVER_QUOTA_CONCURRENT);
    assert_int_equal(wait_ns, 0);
    server_quota_leave(quota);
    assert_int_equal(server_quota_enter(quota, &limits, 1, &wait_ns), SERVER_QUOTA_ENTERED);
    assert_int_equal(quota->requests, 4);
    assert_int_equal(quota->refusals[SERVER_QUOTA_CONCURRENT], 1);
}

static void refusals_use_neither_token_nor_place(void **state)
{
    (void)state;
    const struct server_limits limits = {.rate = 2, .concurrent = 1};
    uint64_t wait_ns;
    assert_int_equal(server_quota_enter(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_ENTERED);
    for (int i = 0; i < 10; i++)
        assert_int_equal(server_quota_enter(quota, &limits, SECOND, &wait_ns),
                         SERVER_QUOTA_CONCURRENT);
    server_quota_leave(quota);
    assert_int_equal(server_quota_enter(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_ENTERED);
    server_quota_leave(quota);
    assert_int_equal(server_quota_enter(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_RATE);
    assert_int_equal(quota->entered, 0);
}

static void a_passing_request_takes_no_place(void **state)
{
    (void)state;
    const struct server_limits limits = {.rate = 3, .concurrent = 1};
    uint64_t wait_ns;
    assert_int_equal(server_quota_enter(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_ENTERED);
    for (int i = 0; i < 2; i++)
        assert_int_equal(server_quota_pass(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_ENTERED);
    assert_int_equal(server_quota_pass(quota, &limits, SECOND, &wait_ns), SERVER_QUOTA_RATE);
    assert_in_range(wait_ns, 1, SECOND / 3);
    assert_int_equal(quota->entered, 1);
    assert_int_equal(quota->requests, 4);
}

#define THREADS 4
#define ROUNDS  20000

static void *contend(void *user)
{
    const struct server_limits limits = {.rate = 1000, .concurrent = 2};
    size_t *entered = user;
    for (int i = 0; i < ROUNDS; i++) {
        uint64_t wait_ns;
        if (server_quota_enter(quota, &limits, SECOND, &wait_ns) != SERVER_QUOTA_ENTERED) continue;
        assert_in_range(quota->entered, 1, THREADS);
        (*entered)++;
        server_quota_leave(quota);
    }
    return NULL;
}

/* While the time does not change, the bucket has tokens for exactly one second, whatever the number
 * of threads. */
static void threads_share_one_bucket(void **state)
{
    (void)state;
    pthread_t threads[THREADS];
    size_t entered[THREADS] = {0}, total = 0;
    for (int i = 0; i < THREADS; i++) pthread_create(&threads[i], NULL, contend, &entered[i]);
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        total += entered[i];
    }
    assert_int_equal(total, 1000);
    assert_int_equal(quota->entered, 0);
    assert_int_equal(quota->requests, THREADS * ROUNDS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_burst_is_as_large_as_the_rate, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_average_rate_is_kept, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_client_that_waits_for_retry_after_is_admitted, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(concurrent_requests_are_limited, set_up, tear_down),
        cmocka_unit_test_setup_teardown(refusals_use_neither_token_nor_place, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_passing_request_takes_no_place, set_up, tear_down),
        cmocka_unit_test_setup_teardown(threads_share_one_bucket, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
