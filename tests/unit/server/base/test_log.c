#include "tests/unit/server/support.h"

#include <jansson.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "server/base/log.h"

/* Closes the line without writing it, and parses it as JSON. */
static json_t *parse(struct server_log_line *line)
{
    json_error_t error;
    char text[SERVER_LOG_LINE + 2];
    memcpy(text, line->text, line->size);
    strcpy(text + line->size, "}");
    json_t *document = json_loads(text, JSON_REJECT_DUPLICATES, &error);
    if (!document) fail_msg("%s in %s", error.text, text);
    return document;
}

static void any_text_is_valid_json(void **state)
{
    (void)state;
    struct server_log_line line;
    assert_true(server_log_begin(&line, SERVER_LOG_ERROR, "test"));
    server_log_text(&line, "odd", "quote \" backslash \\ newline \n tab \t \x01 \x7f \xc3\xa9");
    server_log_text(&line, "absent", NULL);
    server_log_integer(&line, "number", INT64_MIN);
    server_log_milliseconds(&line, "ms", 1234567);
    json_t *document = parse(&line);
    assert_string_equal(json_string_value(json_object_get(document, "event")), "test");
    assert_string_equal(json_string_value(json_object_get(document, "level")), "error");
    assert_non_null(strstr(json_string_value(json_object_get(document, "odd")),
                           "quote \" backslash \\ newline \n"));
    assert_null(json_object_get(document, "absent"));
    assert_true(json_real_value(json_object_get(document, "ms")) == 1.235);
    json_decref(document);
}

static void long_lines_are_valid_json(void **state)
{
    (void)state;
    static const char fill[] = "\"\\\x01x";
    for (size_t size = 0; size < 3 * SERVER_LOG_LINE; size += 7) {
        struct server_log_line line;
        char text[3 * SERVER_LOG_LINE + 1];
        for (size_t i = 0; i < size; i++) text[i] = fill[i % 4];
        text[size] = '\0';
        assert_true(server_log_begin(&line, SERVER_LOG_ERROR, "test"));
        for (int i = 0; i < 8; i++) {
            char key[16];
            snprintf(key, sizeof key, "key%d", i);
            server_log_text(&line, key, text);
        }
        server_log_integer(&line, "last", 1);
        json_decref(parse(&line));
    }
}

static void lines_below_the_level_are_omitted(void **state)
{
    (void)state;
    struct server_log_line line;
    server_log_set_level(SERVER_LOG_WARN);
    assert_false(server_log_begin(&line, SERVER_LOG_INFO, "test"));
    assert_true(server_log_begin(&line, SERVER_LOG_WARN, "test"));
    server_log_set_level(SERVER_LOG_DEBUG);
    assert_true(server_log_begin(&line, SERVER_LOG_DEBUG, "test"));
}

/* --- standard error is redirected to a file --------------------------------------------------- */

struct capture {
    FILE *file;
    int kept;
};

static int begin_capture(void **state)
{
    static struct capture capture;
    capture = (struct capture){tmpfile(), dup(STDERR_FILENO)};
    *state = &capture;
    server_log_set_level(SERVER_LOG_INFO);
    return capture.file && dup2(fileno(capture.file), STDERR_FILENO) >= 0 ? 0 : -1;
}

static int end_capture(void **state)
{
    struct capture *capture = *state;
    dup2(capture->kept, STDERR_FILENO);
    close(capture->kept);
    return fclose(capture->file);
}

/* Checks the events of the written lines, given in order as "a b ". */
static void assert_written(const struct capture *capture, const char *events)
{
    const struct timespec moment = {.tv_nsec = 5000000};
    char text[4096], found[256] = "";
    ssize_t size = 0, lines = 0, wanted = 0;
    for (const char *c = events; *c; c++) wanted += *c == ' ';
    for (int i = 0; i < 2000 && lines < wanted; i++) {
        size = pread(fileno(capture->file), text, sizeof text - 1, 0);
        assert_true(size >= 0);
        for (ssize_t at = lines = 0; at < size; at++) lines += text[at] == '\n';
        if (lines < wanted) nanosleep(&moment, NULL);
    }
    text[size] = '\0';
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        json_t *document = json_loads(line, JSON_REJECT_DUPLICATES, NULL);
        assert_non_null(document);
        strcat(strcat(found, json_string_value(json_object_get(document, "event"))), " ");
        json_decref(document);
    }
    assert_string_equal(found, events);
}

static void say(const char *event, void (*end)(struct server_log_line *line))
{
    struct server_log_line line;
    assert_true(server_log_begin(&line, SERVER_LOG_INFO, event));
    end(&line);
}

static void keeps_the_order_of_lines(void **state)
{
    server_log_start();
    say("a", server_log_end_soon);
    say("b", server_log_end_soon);
    say("c", server_log_end);
    assert_written(*state, "a b c ");
    say("d", server_log_end_soon);
    server_log_stop();
    assert_written(*state, "a b c d ");
    say("e", server_log_end_soon);
    assert_written(*state, "a b c d e ");
}

static void gathered_lines_are_written_soon(void **state)
{
    server_log_start();
    say("a", server_log_end_soon);
    assert_written(*state, "a ");
    server_log_stop();
}

static void a_full_buffer_loses_no_line(void **state)
{
    struct capture *capture = *state;
    struct stat status;
    server_log_start();
    for (int i = 0; i < 10000; i++) say("many", server_log_end_soon);
    server_log_stop();
    assert_int_equal(fstat(fileno(capture->file), &status), 0);
    assert_int_equal(
        status.st_size,
        10000 *
            strlen(
                "{\"time\":\"2026-01-01T00:00:00.000Z\",\"level\":\"info\",\"event\":\"many\"}\n"));
}

enum { THREADS = 4, LINES = 2000 };

/* Writes many lines, some of them immediately. */
static void *say_many(void *number)
{
    for (int i = 0; i < LINES; i++) {
        struct server_log_line line;
        server_log_begin(&line, SERVER_LOG_INFO, "many");
        server_log_integer(&line, "thread", *(const int *)number);
        server_log_integer(&line, "line", i);
        (i % 997 ? server_log_end_soon : server_log_end)(&line);
    }
    return NULL;
}

/* Stops and restarts the log thread while threads write lines. */
static void keeps_the_order_of_each_thread(void **state)
{
    struct capture *capture = *state;
    pthread_t threads[THREADS];
    int numbers[THREADS], seen[THREADS] = {0}, thread, line;
    char text[256];
    server_log_start();
    for (int i = 0; i < THREADS; i++) {
        numbers[i] = i;
        assert_int_equal(pthread_create(&threads[i], NULL, say_many, &numbers[i]), 0);
    }
    server_log_stop();
    server_log_start();
    for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    server_log_stop();
    rewind(capture->file);
    while (fgets(text, sizeof text, capture->file)) {
        assert_int_equal(
            sscanf(strstr(text, "\"thread\""), "\"thread\":%d,\"line\":%d}", &thread, &line), 2);
        assert_int_equal(line, seen[thread]++);
    }
    for (int i = 0; i < THREADS; i++) assert_int_equal(seen[i], LINES);
}

/* --- standard error that is not read ---------------------------------------------------------- */

enum { STUCK_LINES = 40000 };

static int begin_stuck(void **state)
{
    static int ends[2];
    static int kept;
    kept = dup(STDERR_FILENO);
    if (pipe(ends) != 0 || dup2(ends[1], STDERR_FILENO) < 0 || close(ends[1]) != 0) return -1;
    ends[1] = kept;
    *state = ends;
    alarm(60);
    return server_log_start() ? 0 : -1;
}

static int end_stuck(void **state)
{
    const int *ends = *state;
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    alarm(0);
    return close(ends[0]);
}

static void say_numbered(int number)
{
    struct server_log_line line;
    assert_true(server_log_begin(&line, SERVER_LOG_INFO, "numbered"));
    server_log_integer(&line, "number", number);
    (number % 97 ? server_log_end_soon : server_log_end)(&line);
}

/* Reads lines up to that number. Each has the next number, or follows a line with the number of
 * missing lines. */
static void read_up_to(FILE *file, int last)
{
    char text[SERVER_LOG_LINE];
    int next = 0, number;
    while (next <= last && fgets(text, sizeof text, file)) {
        const char *missing = strstr(text, "\"log_dropped\",\"lines\":");
        if (missing) {
            next += atoi(missing + strlen("\"log_dropped\",\"lines\":"));
            continue;
        }
        assert_int_equal(sscanf(strstr(text, "\"number\""), "\"number\":%d}", &number), 1);
        assert_int_equal(number, next++);
    }
    assert_int_equal(next, last + 1);
}

static void never_blocks_and_counts_dropped_lines(void **state)
{
    FILE *file = fdopen(dup(((const int *)*state)[0]), "r");
    uint64_t before = server_log_dropped();
    for (int i = 0; i < STUCK_LINES; i++) say_numbered(i);
    assert_true(server_log_dropped() > before);
    read_up_to(file, STUCK_LINES - 1);
    server_log_stop();
    fclose(file);
}

/* Runs in a child process, because the daemon does not join the thread that waits for the
 * reader. */
static void stops_without_a_reader(void **state)
{
    (void)state;
    int ends[2], status;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) {
        alarm(20);
        if (dup2(ends[1], STDERR_FILENO) < 0 || !server_log_start()) _exit(1);
        for (int i = 0; i < STUCK_LINES; i++) say_numbered(i);
        server_log_stop();
        exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    close(ends[0]);
    close(ends[1]);
}

/* The lines before a crash are written, and the process ends by the same signal. */
static void a_crash_loses_no_line(void **state)
{
    (void)state;
    static const int numbers[] = {SIGSEGV, SIGABRT};
    for (size_t i = 0; i < 2; i++) {
        int ends[2], status;
        assert_int_equal(pipe(ends), 0);
        pid_t child = fork();
        if (child == 0) {
            if (dup2(ends[1], STDERR_FILENO) < 0 || !server_log_start()) _exit(1);
            signal(numbers[i], SIG_DFL); /* replaces the handlers of cmocka or of a sanitizer */
            server_log_flush_at_crash();
            for (int line = 0; line < 100; line++) say_numbered(line);
            raise(numbers[i]);
            _exit(1);
        }
        close(ends[1]);
        FILE *file = fdopen(ends[0], "r");
        read_up_to(file, 99);
        fclose(file);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status) && WTERMSIG(status) == numbers[i]);
    }
}

int main(void)
{
    signal(SIGPIPE, SIG_IGN); /* as the daemon does */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_text_is_valid_json),
        cmocka_unit_test(long_lines_are_valid_json),
        cmocka_unit_test(lines_below_the_level_are_omitted),
        cmocka_unit_test_setup_teardown(keeps_the_order_of_lines, begin_capture, end_capture),
        cmocka_unit_test_setup_teardown(gathered_lines_are_written_soon, begin_capture,
                                        end_capture),
        cmocka_unit_test_setup_teardown(a_full_buffer_loses_no_line, begin_capture, end_capture),
        cmocka_unit_test_setup_teardown(keeps_the_order_of_each_thread, begin_capture, end_capture),
        cmocka_unit_test_setup_teardown(never_blocks_and_counts_dropped_lines, begin_stuck,
                                        end_stuck),
        cmocka_unit_test(stops_without_a_reader),
        cmocka_unit_test(a_crash_loses_no_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
