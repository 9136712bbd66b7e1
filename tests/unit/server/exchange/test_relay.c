#include "tests/unit/server/support.h"

#include "server/exchange/events.h"
#include "server/exchange/relay.h"
#include "server/server.h"

static struct server server;
static struct server_relay *relay;
static struct server_stream *stream;

static void ignore(void *user)
{
    (void)user;
}

static bool is_gone(void *user)
{
    (void)user;
    return false;
}

static int set_up(void **state)
{
    (void)state;
    server_budget_init(&server.budget, 64 << 20);
    server.host.events = server_events_create();
    server.host.workers = server_workers_create(1, 10);
    server_connect(&server);
    relay = server_relay_create(&server.host, &server.budget.common, false);
    stream = server_relay_open(relay);
    server_stream_attach(stream, (struct server_stream_reader){ignore, ignore, is_gone, NULL});
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    server_stream_close(stream);
    server_relay_release(relay);
    server_workers_destroy(server.host.workers);
    server_events_destroy(server.host.events);
    assert_int_equal(server.budget.total, 0);
    return 0;
}

static void write_blocks(char byte, size_t count)
{
    char block[4096];
    memset(block, byte, sizeof block);
    for (size_t i = 0; i < count; i++) server_relay_write(relay, block, sizeof block);
}

/* Reads `size` bytes; asserts that all are `expected`. */
static void assert_reads(char expected, size_t size)
{
    char bytes[4096];
    while (size > 0) {
        ptrdiff_t read =
            server_stream_read(stream, bytes, size < sizeof bytes ? size : sizeof bytes);
        assert_true(read > 0);
        for (ptrdiff_t i = 0; i < read; i++) assert_int_equal(bytes[i], expected);
        size -= (size_t)read;
    }
}

static void assert_ends(ptrdiff_t how)
{
    char byte;
    assert_int_equal(server_stream_read(stream, &byte, 1), how);
}

static void passes_all_bytes_in_order_and_ends(void **state)
{
    (void)state;
    write_blocks('a', 3);
    assert_reads('a', 5000);
    write_blocks('b', 20);
    assert_reads('a', 3 * 4096 - 5000);
    server_relay_end(relay, true);
    assert_reads('b', 20 * 4096);
    assert_ends(SERVER_STREAM_END);
}

static void reports_a_cut(void **state)
{
    (void)state;
    write_blocks('a', 1);
    server_relay_end(relay, false);
    assert_reads('a', 4096);
    assert_ends(SERVER_STREAM_CUT);
}

static void a_writer_that_is_far_ahead_waits_until_half_is_read(void **state)
{
    (void)state;
    const size_t blocks = SERVER_RELAY_MOST / 4096;
    struct test_job job;
    test_job_init(&job, NULL);
    write_blocks('a', blocks - 1);
    assert_false(server_relay_wait(relay, &job.job));
    write_blocks('a', 1);
    assert_true(server_relay_wait(relay, &job.job));
    assert_reads('a', SERVER_RELAY_MOST / 4);
    assert_int_equal(server_workers_load(server.host.workers).queued + job.runs, 0);
    assert_reads('a', SERVER_RELAY_MOST / 4);
    sem_wait(&job.done);
    assert_false(server_relay_wait(relay, &job.job));
    server_relay_end(relay, true);
    assert_reads('a', SERVER_RELAY_MOST / 2);
    assert_ends(SERVER_STREAM_END);
}

static void a_parked_writer_resumes_when_the_client_leaves(void **state)
{
    (void)state;
    struct test_job job;
    test_job_init(&job, NULL);
    write_blocks('a', SERVER_RELAY_MOST / 4096);
    assert_true(server_relay_wait(relay, &job.job));
    assert_false(server_relay_is_over(relay));
    server_stream_close(stream);
    stream = NULL;
    sem_wait(&job.done);
    assert_true(server_relay_is_over(relay));
    assert_false(server_relay_wait(relay, &job.job));
    write_blocks('a', 1); /* no reader is left */
    server_relay_end(relay, true);
}

static void no_writer_waits_when_the_daemon_ends(void **state)
{
    (void)state;
    struct test_job job;
    test_job_init(&job, NULL);
    server_workers_cancel(server.host.workers);
    write_blocks('a', SERVER_RELAY_MOST / 4096);
    assert_false(server_relay_wait(relay, &job.job));
    assert_true(server_relay_is_over(relay));
    server_relay_end(relay, true);
    assert_reads('a', SERVER_RELAY_MOST);
    assert_ends(SERVER_STREAM_CUT);
}

/* --- a writer that blocks */

#define BLOCKS 1000

static void *write_all(void *user)
{
    char block[4096];
    memset(block, 'x', sizeof block);
    bool *is_whole = user;
    *is_whole = true;
    for (int i = 0; i < BLOCKS && *is_whole; i++) {
        server_relay_write(relay, block, sizeof block);
        *is_whole = server_relay_block(relay);
    }
    server_relay_end(relay, *is_whole);
    return NULL;
}

static void a_writer_blocks_until_its_client_reads(void **state)
{
    (void)state;
    bool is_whole;
    pthread_t writer;
    assert_int_equal(pthread_create(&writer, NULL, write_all, &is_whole), 0);
    size_t left = (size_t)BLOCKS * 4096;
    char bytes[5000];
    while (left > 0) {
        ptrdiff_t read = server_stream_read(stream, bytes, sizeof bytes);
        assert_true(read >= 0);
        left -= (size_t)read;
        assert_true(atomic_load(&server.budget.total) < 2 * SERVER_RELAY_MOST);
    }
    pthread_join(writer, NULL);
    assert_true(is_whole);
    assert_int_equal(server_stream_read(stream, bytes, sizeof bytes), SERVER_STREAM_END);
}

static void a_blocked_writer_ends_when_its_client_leaves(void **state)
{
    (void)state;
    bool is_whole;
    pthread_t writer;
    assert_int_equal(pthread_create(&writer, NULL, write_all, &is_whole), 0);
    char bytes[5000];
    while (server_stream_read(stream, bytes, sizeof bytes) == 0) continue;
    server_stream_close(stream);
    stream = NULL;
    pthread_join(writer, NULL);
    assert_false(is_whole);
}

static void a_blocked_writer_ends_with_the_daemon(void **state)
{
    (void)state;
    bool is_whole;
    pthread_t writer;
    assert_int_equal(pthread_create(&writer, NULL, write_all, &is_whole), 0);
    server_workers_cancel(server.host.workers);
    pthread_join(writer, NULL);
    assert_false(is_whole);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(passes_all_bytes_in_order_and_ends),
        TEST(reports_a_cut),
        TEST(a_writer_that_is_far_ahead_waits_until_half_is_read),
        TEST(a_parked_writer_resumes_when_the_client_leaves),
        TEST(no_writer_waits_when_the_daemon_ends),
        TEST(a_writer_blocks_until_its_client_reads),
        TEST(a_blocked_writer_ends_when_its_client_leaves),
        TEST(a_blocked_writer_ends_with_the_daemon),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
