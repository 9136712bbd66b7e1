#include "tests/unit/server/support.h"

#include "gd/control.h"
#include "server/exchange/events.h"

#define SECOND UINT64_C(1000000000)

/* A source of events with a counter, and a reader that records its calls. */
static struct {
    uint64_t version;
    bool is_last, is_content;
    int told, released;
} source;

static struct {
    int pauses, resumes;
    bool is_gone;
} reader;

static uint64_t version(void *user)
{
    (void)user;
    return source.version;
}

static bool tell(void *user, struct proto_writer *writer)
{
    (void)user;
    proto_append_format(writer, "news %d\n\n", ++source.told);
    return !source.is_last;
}

/* Writes the content of a source, which is "news N" for each unread version. Returns the same
 * values as the read function of a relay. */
static ptrdiff_t read_content(void *user, char *bytes, size_t size)
{
    (void)user;
    if (source.version < (uint64_t)source.told) return source.is_last ? SERVER_STREAM_END : 0;
    return snprintf(bytes, size, "news %d\n\n", ++source.told);
}

static void release(void *user)
{
    (void)user;
    source.released++;
}

static void pause_reader(void *user)
{
    (void)user;
    reader.pauses++;
}

static void resume_reader(void *user)
{
    (void)user;
    reader.resumes++;
}

static bool is_gone(void *user)
{
    (void)user;
    return reader.is_gone;
}

static struct server_events *events;

static int set_up(void **state)
{
    (void)state;
    memset(&source, 0, sizeof source);
    memset(&reader, 0, sizeof reader);
    events = server_events_create();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    assert_int_equal(server_events_count(events), 0);
    server_events_destroy(events);
    return 0;
}

static struct server_stream *open_stream(void)
{
    const struct server_event_source told = {.version = version,
                                             .write = tell,
                                             .read = source.is_content ? read_content : NULL,
                                             .release = release,
                                             .user = &source};
    struct server_stream *stream = server_stream_open(events, &told);
    server_stream_attach(stream,
                         (struct server_stream_reader){pause_reader, resume_reader, is_gone, NULL});
    return stream;
}

static void assert_reads(struct server_stream *stream, const char *expected)
{
    char bytes[64];
    ptrdiff_t size = server_stream_read(stream, bytes, sizeof bytes);
    assert_int_equal(size, strlen(expected));
    assert_memory_equal(bytes, expected, strlen(expected));
}

static void assert_pauses(struct server_stream *stream)
{
    char byte;
    int before = reader.pauses;
    assert_int_equal(server_stream_read(stream, &byte, 1), 0);
    assert_int_equal(reader.pauses, before + 1);
}

static void assert_ended(struct server_stream *stream)
{
    char byte;
    assert_int_equal(server_stream_read(stream, &byte, 1), -1);
}

static void sends_the_present_state_and_then_waits(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    assert_int_equal(server_events_count(events), 1);
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    server_events_tick(events, gd_now_ns());
    assert_int_equal(reader.resumes, 0);
    server_stream_close(stream);
    assert_int_equal(source.released, 1);
}

static void a_message_is_read_in_pieces_of_any_size(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    char bytes[16] = "";
    for (int i = 0; i < 8; i++) assert_int_equal(server_stream_read(stream, bytes + i, 1), 1);
    assert_string_equal(bytes, "news 1\n\n");
    assert_pauses(stream);
    server_stream_close(stream);
}

static void a_wake_resumes_only_its_own_streams(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    server_events_wake(events, &reader);
    assert_int_equal(reader.resumes, 0);
    server_events_wake(events, &source);
    server_events_wake(events, &source); /* a reader that is not paused is not resumed */
    assert_int_equal(reader.resumes, 1);
    assert_reads(stream, "news 2\n\n");
    assert_pauses(stream);
    server_stream_close(stream);
}

static void progress_is_sent_at_most_ten_times_a_second(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    source.version++;
    server_events_tick(events, gd_now_ns());
    assert_int_equal(reader.resumes, 0);
    server_events_tick(events, gd_now_ns() + SECOND / 10);
    assert_int_equal(reader.resumes, 1);
    server_stream_close(stream);
}

static void heartbeats_break_the_silence(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    server_events_tick(events, gd_now_ns() + 14 * SECOND);
    assert_int_equal(reader.resumes, 0);
    server_events_tick(events, gd_now_ns() + 15 * SECOND);
    assert_int_equal(reader.resumes, 1);
    server_stream_close(stream);
}

static void the_last_message_ends_the_stream(void **state)
{
    (void)state;
    source.is_last = true;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_ended(stream);
    server_events_wake(events, &source);
    assert_ended(stream);
    server_stream_close(stream);
}

static void a_client_that_hung_up_ends_its_stream(void **state)
{
    (void)state;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    reader.is_gone = true;
    server_events_tick(events, gd_now_ns());
    assert_int_equal(reader.resumes, 1);
    assert_ended(stream);
    server_stream_close(stream);
}

static void the_end_ends_all_streams(void **state)
{
    (void)state;
    struct server_stream *paused = open_stream();
    assert_reads(paused, "news 1\n\n");
    assert_pauses(paused);
    server_events_end(events);
    assert_int_equal(reader.resumes, 1);
    assert_ended(paused);
    struct server_stream *late = open_stream();
    assert_reads(late, "news 2\n\n");
    assert_ended(late);
    server_stream_close(paused);
    server_stream_close(late);
}

static void content_is_sent_only_when_woken(void **state)
{
    (void)state;
    source.is_content = true;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    source.version++;
    assert_reads(stream, "news 2\n\n");
    assert_pauses(stream);
    server_events_end(events);
    server_events_tick(events, gd_now_ns() + 60 * SECOND);
    assert_int_equal(reader.resumes, 0);
    source.version++;
    source.is_last = true;
    server_events_wake(events, &source);
    assert_int_equal(reader.resumes, 1);
    assert_reads(stream, "news 3\n\n");
    assert_ended(stream);
    server_stream_close(stream);
}

static void cut_content_ends_with_an_error(void **state)
{
    (void)state;
    char byte;
    source.is_content = true;
    struct server_stream *stream = open_stream();
    assert_reads(stream, "news 1\n\n");
    assert_pauses(stream);
    reader.is_gone = true;
    server_events_tick(events, gd_now_ns() + 2 * SECOND);
    assert_int_equal(server_stream_read(stream, &byte, 1), SERVER_STREAM_CUT);
    server_stream_close(stream);
}

static void many_streams_open_and_close(void **state)
{
    (void)state;
    struct server_stream *streams[5];
    for (int i = 0; i < 5; i++) streams[i] = open_stream();
    static const int order[] = {2, 0, 4, 1, 3};
    for (int i = 0; i < 5; i++) {
        server_stream_close(streams[order[i]]);
        server_events_wake(events, &source); /* visits the remaining streams */
    }
    assert_int_equal(source.released, 5);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(sends_the_present_state_and_then_waits),
        TEST(a_message_is_read_in_pieces_of_any_size),
        TEST(a_wake_resumes_only_its_own_streams),
        TEST(progress_is_sent_at_most_ten_times_a_second),
        TEST(heartbeats_break_the_silence),
        TEST(the_last_message_ends_the_stream),
        TEST(a_client_that_hung_up_ends_its_stream),
        TEST(the_end_ends_all_streams),
        TEST(content_is_sent_only_when_woken),
        TEST(cut_content_ends_with_an_error),
        TEST(many_streams_open_and_close),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
