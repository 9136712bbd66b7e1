#include "server/base/log.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "proto/json/number.h"
#include "server/base/thread.h"

/* leaves room for the brace and the newline at the line's end */
#define LINE_ROOM  (SERVER_LOG_LINE - 2)
#define TEXT_LIMIT 512 /* largest number of bytes of a text member */
/* longest time that a line waits in the buffer for further lines */
#define GATHER_NS     10000000
#define GATHERED_MOST (1 << 20) /* bytes of one of the two buffers */
/* the thread is woken if the buffer has this many bytes, which still fit in a processor cache */
#define GATHERED_DUE (32 << 10)
#define NOTE_ROOM    256 /* room reserved for the line `log_dropped` */
/* longest time that a caller waits to write its own line */
#define DIRECT_MS     100
#define LAST_LINES_NS UINT64_C(1000000000)
#define CRASH_MS      200

/* --- lines ------------------------------------------------------------------------------------ */

const char *const server_log_levels[] = {"debug", "info", "warn", "error", NULL};

static enum server_log_level threshold = SERVER_LOG_INFO;

void server_log_set_level(enum server_log_level level)
{
    threshold = level;
}

static char *line_put(char *at, const char *bytes, size_t size)
{
    return (char *)memcpy(at, bytes, size) + size;
}

/* Appends a member whose value is JSON, if the line has room for it. */
static void line_append(struct server_log_line *line, const char *key, const char *value,
                        size_t size)
{
    size_t key_size = strlen(key);
    char *at = line->text + line->size;
    if (key_size + size + strlen(",\"\":") > LINE_ROOM - line->size) return;
    at = line_put(line_put(line_put(at, ",\"", 2), key, key_size), "\":", 2);
    line->size = (size_t)(line_put(at, value, size) - line->text);
}

/* Returns the time as text, such as "2026-01-31T12:34:56". Each thread formats the text at most
 * once a second. */
static const char *second_text(time_t second)
{
    static _Thread_local time_t known = -1;
    static _Thread_local char text[64];
    struct tm utc;
    if (second == known || !gmtime_r(&second, &utc)) return text;
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
    known = second;
    return text;
}

/* Writes a point and three digits. Returns the end of the digits. */
static char *thousandths_print(unsigned thousandths, char *out)
{
    *out++ = '.';
    for (unsigned unit = 100; unit; unit /= 10) *out++ = (char)('0' + thousandths / unit % 10);
    return out;
}

bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event)
{
    if (level < threshold) return false;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    char *end = stpcpy(stpcpy(line->text, "{\"time\":\""), second_text(now.tv_sec));
    end = stpcpy(thousandths_print((unsigned)(now.tv_nsec / 1000000), end), "Z\"");
    line->size = (size_t)(end - line->text);
    server_log_text(line, "level", server_log_levels[level]);
    server_log_text(line, "event", event);
    return true;
}

void server_log_text(struct server_log_line *line, const char *key, const char *value)
{
    static const bool is_plain[256] = {
        [' ' ... '!'] = true, ['#' ... '['] = true, [']' ... '~'] = true};
    char text[TEXT_LIMIT + sizeof "\"\\u0000\""], *end = text;
    if (!value) return;
    *end++ = '"';
    for (; *value && end <= text + TEXT_LIMIT; value++) {
        if (is_plain[(unsigned char)*value])
            *end++ = *value;
        else
            end += sprintf(end, *value == '"' || *value == '\\' ? "\\%c" : "\\u%04x",
                           (unsigned char)*value);
    }
    *end++ = '"';
    line_append(line, key, text, (size_t)(end - text));
}

void server_log_integer(struct server_log_line *line, const char *key, int64_t value)
{
    char text[PROTO_INTEGER_SIZE + 1] = "-";
    bool negative = value < 0;
    uint64_t magnitude = negative ? 0 - (uint64_t)value : (uint64_t)value;
    line_append(line, key, text, negative + proto_integer_print(magnitude, text + negative));
}

void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds)
{
    char text[PROTO_INTEGER_SIZE + 4];
    uint64_t microseconds = (nanoseconds + 500) / 1000;
    char *end = text + proto_integer_print(microseconds / 1000, text);
    end = thousandths_print((unsigned)(microseconds % 1000), end);
    line_append(line, key, text, (size_t)(end - text));
}

/* --- output ----------------------------------------------------------------------------------- */
/* There are two buffers. Callers append to one buffer while the thread writes the other. Only the
 * thread blocks when standard error is a full pipe. */

struct text {
    size_t size;
    char bytes[GATHERED_MOST];
};

/* These buffers are not members of `output`. As members, they would be a part of the program's
 * file, because `output` has an initial value. */
static struct text texts[2];

static struct {
    pthread_mutex_t lock;
    struct server_thread *thread; /* NULL means that the thread is not started, or is stopping */
    /* true if lines are buffered, and written by the thread or at its stop */
    bool is_gathering;
    bool is_urgent; /* true if `gathering` must be written at once */
    /* true if `gathering` is full, and later lines are dropped and counted */
    bool is_full;
    struct text *gathering, *other;
    uint64_t noted;        /* number of dropped lines that the log has reported */
    atomic_bool is_behind; /* true if some line is not written yet */
    atomic_uint_least64_t dropped;
} output = {.lock = PTHREAD_MUTEX_INITIALIZER, .gathering = &texts[0], .other = &texts[1]};

uint64_t server_log_dropped(void)
{
    return atomic_load_explicit(&output.dropped, memory_order_relaxed);
}

/* Waits until standard error has room. A negative time means no limit. Returns false at a timeout
 * or an error. */
static bool stderr_wait(int milliseconds)
{
    struct pollfd state = {.fd = STDERR_FILENO, .events = POLLOUT};
    int found = poll(&state, 1, milliseconds);
    return found > 0 || (found < 0 && errno == EINTR);
}

/* Writes `most` bytes at a time. Stops at an error, and after `patience_ms` without room (negative
 * means no limit). Counts the lines that remain as dropped. */
static void stderr_write(const char *bytes, size_t size, size_t most, int patience_ms)
{
    while (size) {
        if (patience_ms >= 0 && !stderr_wait(patience_ms)) break;
        ssize_t written = write(STDERR_FILENO, bytes, size < most ? size : most);
        if (written > 0) {
            bytes += written;
            size -= (size_t)written;
        } else if (errno != EINTR && (errno != EAGAIN || !stderr_wait(patience_ms))) {
            break; /* EAGAIN: another process made standard error non-blocking */
        }
    }
    for (const char *end; (end = memchr(bytes, '\n', size)); bytes = end + 1) {
        size -= (size_t)(end + 1 - bytes);
        atomic_fetch_add(&output.dropped, 1);
    }
}

static bool text_add(struct text *text, const struct server_log_line *line, size_t most)
{
    if (line->size > most - text->size) return false;
    memcpy(text->bytes + text->size, line->text, line->size);
    text->size += line->size;
    return true;
}

static void line_close(struct server_log_line *line)
{
    memcpy(line->text + line->size, "}\n", 2);
    line->size += 2;
}

/* Exchanges the buffers under the lock, and returns the gathered text for the caller to write.
 * Appends the line `log_dropped` if lines were dropped. */
static struct text *texts_swap(void)
{
    struct text *full = output.gathering;
    struct server_log_line note;
    uint64_t dropped = server_log_dropped();
    if (dropped > output.noted && server_log_begin(&note, SERVER_LOG_WARN, "log_dropped")) {
        server_log_integer(&note, "lines", (int64_t)(dropped - output.noted));
        server_log_text(&note, "message", "standard error was not read fast enough");
        line_close(&note);
        output.noted = dropped;
        (void)text_add(full, &note, GATHERED_MOST); /* NOTE_ROOM was reserved for this line */
    }
    output.gathering = output.other;
    output.other = full;
    output.is_full = output.is_urgent = false;
    return full;
}

static void write_gathered(void)
{
    pthread_mutex_lock(&output.lock);
    struct text *text = texts_swap();
    pthread_mutex_unlock(&output.lock);
    stderr_write(text->bytes, text->size, SIZE_MAX, -1);
    text->size = 0;
    pthread_mutex_lock(&output.lock);
    atomic_store(&output.is_behind, output.gathering->size > 0);
    pthread_mutex_unlock(&output.lock);
}

static void write_lines(void *user, struct server_thread *thread)
{
    (void)user;
    for (bool goes_on = true; goes_on;) {
        goes_on = server_thread_pause(thread, SERVER_THREAD_FOREVER);
        pthread_mutex_lock(&output.lock);
        bool is_urgent = output.is_urgent;
        pthread_mutex_unlock(&output.lock);
        if (goes_on && !is_urgent) goes_on = server_thread_pause(thread, GATHER_NS);
        write_gathered();
    }
}

/* Appends a line under the lock. Wakes the thread for the first line in an empty buffer, for an
 * urgent line, and when the buffer has GATHERED_DUE bytes. */
static void line_gather(const struct server_log_line *line, bool is_urgent)
{
    struct text *text = output.gathering;
    bool is_first = text->size == 0;
    output.is_full = output.is_full || !text_add(text, line, GATHERED_MOST - NOTE_ROOM);
    if (output.is_full) {
        atomic_fetch_add_explicit(&output.dropped, 1, memory_order_relaxed);
        return;
    }
    bool becomes_urgent = !output.is_urgent && (is_urgent || text->size >= GATHERED_DUE);
    output.is_urgent = output.is_urgent || becomes_urgent;
    atomic_store_explicit(&output.is_behind, true, memory_order_relaxed);
    if ((is_first || becomes_urgent) && output.thread) server_thread_wake(output.thread);
}

static void line_end(struct server_log_line *line, bool is_urgent)
{
    line_close(line);
    SERVER_LOCK(&output.lock);
    if (output.is_gathering)
        line_gather(line, is_urgent);
    else
        stderr_write(line->text, line->size, PIPE_BUF, DIRECT_MS);
}

void server_log_end(struct server_log_line *line)
{
    line_end(line, true);
}

void server_log_end_soon(struct server_log_line *line)
{
    line_end(line, false);
}

void server_log_message(enum server_log_level level, const char *event, const char *format, ...)
{
    struct server_log_line line;
    if (!server_log_begin(&line, level, event)) return;
    char sentence[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    server_log_text(&line, "message", sentence);
    server_log_end(&line);
}

/* --- the thread's life ------------------------------------------------------------------------ */

bool server_log_start(void)
{
    struct server_thread *thread = server_thread_start(write_lines, NULL);
    SERVER_LOCK(&output.lock);
    output.thread = thread;
    output.is_gathering = thread != NULL;
    return thread != NULL;
}

void server_log_stop(void)
{
    pthread_mutex_lock(&output.lock);
    struct server_thread *thread = output.thread;
    output.thread = NULL;
    pthread_mutex_unlock(&output.lock);
    /* after a timeout the thread is blocked on a slow reader: it is abandoned, and later lines are
       lost */
    if (!thread || !server_thread_stop_within(thread, LAST_LINES_NS)) return;
    pthread_mutex_lock(&output.lock);
    struct text *text = texts_swap(); /* lines logged since the thread's last write */
    stderr_write(text->bytes, text->size, PIPE_BUF, DIRECT_MS);
    text->size = 0;
    output.is_gathering = false;
    pthread_mutex_unlock(&output.lock);
}

/* --- crashes ---------------------------------------------------------------------------------- */

static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
static struct sigaction earlier[sizeof crashes / sizeof *crashes];

/* Waits a moment for the thread, then restores the default action, which ends the process.
 * Async-signal-safe. */
static void on_crash(int number, siginfo_t *info, void *context)
{
    int saved = errno;
    (void)context;
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++)
        if (crashes[i] == number) sigaction(number, &earlier[i], NULL);
    for (int i = 0; i < CRASH_MS && atomic_load(&output.is_behind); i++) poll(NULL, 0, 1);
    errno = saved;
    /* si_code <= 0 means that a process sent the signal; a fault recurs when the instruction runs
       again */
    if (info->si_code <= 0) raise(number);
}

void server_log_flush_at_crash(void)
{
    struct sigaction action = {.sa_sigaction = on_crash, .sa_flags = SA_SIGINFO};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++)
        sigaction(crashes[i], &action, &earlier[i]);
}
