/* See log.h. A text is cut at TEXT_LIMIT inside its quotes, and a key whose value does not fit any
 * more is left out: so that every line is valid JSON whatever a client put into it. */
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

#include "proto/number.h"
#include "server/base/printable.h"

#define LINE_RESERVE 2 /* brace, newline */
#define TEXT_LIMIT   512

#define SECOND_NS     1000000000
#define GATHER_NS     10000000  /* a line waits so long for others */
#define GATHERED_MOST (1 << 20) /* bytes of lines that wait; as many are being written */
/* bytes that are written at once: they are in a processor's cache */
#define ENOUGH       (32 << 10)
#define NOTE_SIZE    256 /* of the line that tells of dropped ones */
#define DIRECT_MS    100 /* without the writer's thread: how long a line waits for room */
#define LAST_LINES_S 1   /* at the stop: how long the writer may take for what is left */
#define CRASH_MS     200

const char *const server_log_level_names[SERVER_LOG_LEVEL_COUNT] = {
#define SERVER_LOG_NAME(NAME, name) #name,
    SERVER_LOG_LEVELS(SERVER_LOG_NAME)
#undef SERVER_LOG_NAME
};

static enum server_log_level threshold = SERVER_LOG_INFO;

void server_log_set_level(enum server_log_level level)
{
    threshold = level;
}

/* Appends all of the text or nothing. */
static bool append(struct server_log_line *line, const char *text, size_t size)
{
    if (line->size + size > sizeof line->text - LINE_RESERVE) return false;
    memcpy(line->text + line->size, text, size);
    line->size += size;
    return true;
}

static bool append_text(struct server_log_line *line, const char *text)
{
    return append(line, text, strlen(text));
}

/* Appends ,"KEY": */
static bool append_key(struct server_log_line *line, const char *key)
{
    size_t size = strlen(key);
    if (line->size + size + 4 > sizeof line->text - LINE_RESERVE) return false;
    char *at = line->text + line->size;
    memcpy(at, ",\"", 2);
    memcpy(at + 2, key, size);
    memcpy(at + 2 + size, "\":", 2);
    line->size += size + 4;
    return true;
}

static const bool is_plain[256] = {
    /* neither quote nor backslash */
    [' ' ... '!'] = true,
    ['#' ... '['] = true,
    [']' ... '~'] = true};

/* Bytes from the start of the text, at most `most`, that can be written as they are. */
static size_t plain_run(const char *text, size_t most)
{
    size_t run = 0, size = strnlen(text, most);
    while (size - run >= 8 && server_eight_are_visible(text + run, '"', '\\')) run += 8;
    while (run < size && is_plain[(unsigned char)text[run]]) run++;
    return run;
}

static bool append_escape(struct server_log_line *line, unsigned char character)
{
    char escape[8];
    bool is_short = character == '"' || character == '\\';
    int size = snprintf(escape, sizeof escape, is_short ? "\\%c" : "\\u%04x", character);
    return append(line, escape, (size_t)size);
}

static bool append_escaped(struct server_log_line *line, const char *value)
{
    size_t end = line->size + TEXT_LIMIT;
    while (*value && line->size < end) {
        size_t run = plain_run(value, end - line->size);
        if (run ? !append(line, value, run) : !append_escape(line, (unsigned char)*value))
            return false;
        value += run ? run : 1;
    }
    return true;
}

/* "2026-01-31T12:34:56" of that second; a thread takes a second apart once. */
static const char *time_text(time_t second)
{
    static _Thread_local time_t known = -1;
    static _Thread_local char text[64];
    struct tm utc;
    if (second == known || !gmtime_r(&second, &utc)) return text;
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
    known = second;
    return text;
}

/* Writes a point and three digits. */
static void print_thousandths(unsigned thousandths, char out[4])
{
    *out++ = '.';
    for (unsigned unit = 100; unit; unit /= 10) *out++ = (char)('0' + thousandths / unit % 10);
}

bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event)
{
    if (level < threshold) return false;
    char thousandths[4];
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    line->size = 0;
    append_text(line, "{\"time\":\"");
    append_text(line, time_text(now.tv_sec));
    print_thousandths((unsigned)(now.tv_nsec / 1000000), thousandths);
    append(line, thousandths, sizeof thousandths);
    append_text(line, "Z\",\"level\":\"");
    append_text(line, server_log_level_names[level]);
    append_text(line, "\",\"event\":\"");
    append_text(line, event);
    append_text(line, "\"");
    return true;
}

/* Appends ,"KEY":"VALUE" where all of the value can be written as it is, and has room; else
 * nothing. */
static bool append_plain(struct server_log_line *line, const char *key, const char *value)
{
    size_t key_size = strlen(key), size = plain_run(value, TEXT_LIMIT);
    if (value[size] || line->size + key_size + size + 6 > sizeof line->text - LINE_RESERVE)
        return false;
    char *at = line->text + line->size;
    memcpy(at, ",\"", 2);
    memcpy(at + 2, key, key_size);
    memcpy(at + 2 + key_size, "\":\"", 3);
    memcpy(at + 5 + key_size, value, size);
    at[5 + key_size + size] = '"';
    line->size += key_size + size + 6;
    return true;
}

void server_log_text(struct server_log_line *line, const char *key, const char *value)
{
    size_t start = line->size;
    if (!value || append_plain(line, key, value)) return;
    if (!append_key(line, key) || !append(line, "\"", 1) || !append_escaped(line, value) ||
        !append(line, "\"", 1))
        line->size = start;
}

/* A key and its number's text. */
static void append_number(struct server_log_line *line, const char *key, const char *text,
                          size_t size)
{
    size_t start = line->size;
    if (!append_key(line, key) || !append(line, text, size)) line->size = start;
}

void server_log_integer(struct server_log_line *line, const char *key, int64_t value)
{
    char text[PROTO_INTEGER_SIZE + 1] = "-";
    bool negative = value < 0;
    size_t size =
        proto_integer_print(negative ? 0 - (uint64_t)value : (uint64_t)value, text + negative);
    append_number(line, key, text, size + negative);
}

void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds)
{
    char text[PROTO_INTEGER_SIZE + 4];
    uint64_t microseconds = (nanoseconds + 500) / 1000;
    size_t size = proto_integer_print(microseconds / 1000, text);
    print_thousandths((unsigned)(microseconds % 1000), text + size);
    append_number(line, key, text, size + 4);
}

/* --- to standard error
 * --------------------------------------------------------------------------------------------
 *
 * Lines gather in one text while the writer's thread writes the other one. Only that thread ever
 * waits for the reader of standard error: it may be a pipe that nobody reads. Without the thread
 * (the tools, the first lines, the last ones) a line is written by its caller, who waits DIRECT_MS
 * at most. */

struct text {
    size_t size;
    char bytes[GATHERED_MOST];
};

static struct {
    pthread_mutex_t lock;
    pthread_cond_t change;
    pthread_t writer;
    bool has_writer, is_stopping, has_ended; /* has_ended: the writer has nothing left to do */
    bool is_urgent;                          /* the text is to be written at once */
    /* the text takes no more lines: those that follow are dropped, so that one note tells of all */
    bool is_full;
    struct text *gathering, *other;
    atomic_bool is_behind; /* a line is not written yet */
    atomic_uint_least64_t dropped;
    uint64_t noted; /* lines of `dropped` that a note has told of */
    struct text texts[2];
} output = {
    .lock = PTHREAD_MUTEX_INITIALIZER, .gathering = &output.texts[0], .other = &output.texts[1]};

uint64_t server_log_dropped(void)
{
    return atomic_load_explicit(&output.dropped, memory_order_relaxed);
}

static uint64_t count_lines(const char *bytes, size_t size)
{
    uint64_t lines = 0;
    for (const char *end; (end = memchr(bytes, '\n', size)); bytes = end + 1, lines++)
        size -= (size_t)(end + 1 - bytes);
    return lines;
}

/* Waits until standard error takes bytes; false: it does not, for so long (negative: for ever). */
static bool wait_for_room(int milliseconds)
{
    struct pollfd state = {.fd = STDERR_FILENO, .events = POLLOUT};
    int found = poll(&state, 1, milliseconds);
    return found > 0 || (found < 0 && errno == EINTR);
}

/* Returns how many bytes were written, of which no more than `most` at once. Stops at an error,
 * and after `patience_ms` without room (negative: never). */
static size_t write_bytes(const char *bytes, size_t size, size_t most, int patience_ms)
{
    size_t at = 0;
    while (at < size) {
        if (patience_ms >= 0 && !wait_for_room(patience_ms)) break;
        ssize_t written = write(STDERR_FILENO, bytes + at, size - at < most ? size - at : most);
        if (written > 0)
            at += (size_t)written;
        else if (errno == EAGAIN && !wait_for_room(patience_ms)) /* somebody made it non-blocking */
            break;
        else if (errno != EINTR && errno != EAGAIN)
            break;
    }
    return at;
}

/* Writes a text that is the caller's. Lines that can't be written are counted: there is nowhere
 * to report them. */
static void write_text(struct text *text, size_t most, int patience_ms)
{
    size_t written = write_bytes(text->bytes, text->size, most, patience_ms);
    atomic_fetch_add(&output.dropped, count_lines(text->bytes + written, text->size - written));
    text->size = 0;
}

static bool add_bytes(struct text *text, const char *bytes, size_t size, size_t most)
{
    if (size > most - text->size) return false;
    memcpy(text->bytes + text->size, bytes, size);
    text->size += size;
    return true;
}

static void close_line(struct server_log_line *line)
{
    memcpy(line->text + line->size, "}\n", 2);
    line->size += 2;
}

/* Under the lock: ends a text behind which lines were dropped with a line that says so. */
static void note_dropped(struct text *text)
{
    struct server_log_line line;
    uint64_t dropped = server_log_dropped();
    if (dropped == output.noted || !server_log_begin(&line, SERVER_LOG_WARN, "log_dropped")) return;
    server_log_integer(&line, "lines", (int64_t)(dropped - output.noted));
    server_log_text(&line, "message", "standard error was not read fast enough");
    close_line(&line);
    output.noted = dropped;
    (void)add_bytes(text, line.text, line.size, GATHERED_MOST); /* NOTE_SIZE is kept free for it */
}

/* Under the lock: the text with what has gathered, for the caller to write; lines gather in the
 * other one. */
static struct text *swap_texts(void)
{
    struct text *full = output.gathering;
    note_dropped(full);
    output.gathering = output.other;
    output.other = full;
    output.is_full = output.is_urgent = false;
    return full;
}

/* Under the lock, which is given up meanwhile: until the text is to be written at once, or its
 * lines have had GATHER_NS to gather. */
static void wait_for_lines(void)
{
    struct timespec until;
    while (!output.gathering->size && !output.is_stopping)
        pthread_cond_wait(&output.change, &output.lock);
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += GATHER_NS;
    until.tv_sec += until.tv_nsec / SECOND_NS;
    until.tv_nsec %= SECOND_NS;
    while (!output.is_urgent && !output.is_stopping &&
           pthread_cond_timedwait(&output.change, &output.lock, &until) != ETIMEDOUT)
        continue;
}

static void *write_lines(void *user)
{
    (void)user;
    pthread_mutex_lock(&output.lock);
    while (!output.is_stopping || output.gathering->size) {
        wait_for_lines();
        struct text *text = swap_texts();
        pthread_mutex_unlock(&output.lock);
        write_text(text, SIZE_MAX, -1);
        pthread_mutex_lock(&output.lock);
        atomic_store(&output.is_behind, output.gathering->size > 0);
    }
    output.has_ended = true;
    pthread_cond_signal(&output.change);
    pthread_mutex_unlock(&output.lock);
    return NULL;
}

/* Under the lock: the first line of a text, an urgent one, and the one by which it has ENOUGH
 * bytes, wake the writer. */
static void gather(const struct server_log_line *line, bool is_urgent)
{
    struct text *text = output.gathering;
    size_t before = text->size;
    output.is_full =
        output.is_full || !add_bytes(text, line->text, line->size, GATHERED_MOST - NOTE_SIZE);
    if (output.is_full) {
        atomic_fetch_add_explicit(&output.dropped, 1, memory_order_relaxed);
        return;
    }
    bool is_due = is_urgent || text->size >= ENOUGH;
    bool wakes = !before || (is_due && !output.is_urgent);
    output.is_urgent = output.is_urgent || is_due;
    atomic_store_explicit(&output.is_behind, true, memory_order_relaxed);
    if (wakes) pthread_cond_signal(&output.change);
}

static void end_line(struct server_log_line *line, bool is_urgent)
{
    close_line(line);
    pthread_mutex_lock(&output.lock);
    if (output.has_writer)
        gather(line, is_urgent);
    else if (write_bytes(line->text, line->size, PIPE_BUF, DIRECT_MS) < line->size)
        atomic_fetch_add(&output.dropped, 1);
    pthread_mutex_unlock(&output.lock);
}

void server_log_end(struct server_log_line *line)
{
    end_line(line, true);
}

void server_log_end_soon(struct server_log_line *line)
{
    end_line(line, false);
}

/* --- the writer's life ------------------------------------------------------------------------ */

bool server_log_start(void)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&output.change, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_lock(&output.lock);
    output.is_stopping = output.has_ended = false;
    output.has_writer = pthread_create(&output.writer, NULL, write_lines, NULL) == 0;
    pthread_mutex_unlock(&output.lock);
    return output.has_writer;
}

/* Under the lock, which is given up meanwhile: false, LAST_LINES_S have passed. */
static bool wait_for_writer(void)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += LAST_LINES_S;
    while (!output.has_ended &&
           pthread_cond_timedwait(&output.change, &output.lock, &until) != ETIMEDOUT)
        continue;
    return output.has_ended;
}

/* Under the lock, which is given up meanwhile: ends the writer; false: it still waits for the
 * reader of standard error. */
static bool end_writer(void)
{
    output.is_stopping = true;
    pthread_cond_signal(&output.change);
    bool has_ended = wait_for_writer();
    output.has_writer = !has_ended;
    /* that came meanwhile */
    if (has_ended && output.gathering->size) write_text(swap_texts(), PIPE_BUF, DIRECT_MS);
    return has_ended;
}

/* A thread that still waits is left behind. */
void server_log_stop(void)
{
    pthread_mutex_lock(&output.lock);
    bool had_writer = output.has_writer, has_ended = had_writer && end_writer();
    pthread_mutex_unlock(&output.lock);
    if (has_ended)
        pthread_join(output.writer, NULL);
    else if (had_writer)
        pthread_detach(output.writer);
}

/* --- crashes ---------------------------------------------------------------------------------- */

static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
static struct sigaction before_us[sizeof crashes / sizeof *crashes];

/* The writer goes on while a crashing thread is here, for a moment; then what would have become
 * of the signal does. Calls only what a handler may call. */
static void on_crash(int number, siginfo_t *info, void *context)
{
    int saved = errno;
    (void)context;
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++)
        if (crashes[i] == number) sigaction(number, &before_us[i], NULL);
    for (int i = 0; i < CRASH_MS && atomic_load(&output.is_behind); i++) poll(NULL, 0, 1);
    errno = saved;
    /* sent: else the instruction is run again, and fails again */
    if (info->si_code <= 0) raise(number);
}

void server_log_flush_at_crash(void)
{
    struct sigaction action = {.sa_sigaction = on_crash, .sa_flags = SA_SIGINFO};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++)
        sigaction(crashes[i], &action, &before_us[i]);
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
