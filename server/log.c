/* See log.h. A text is cut at TEXT_LIMIT inside its quotes, and a key whose value does not fit any more is left
 * out: so that every line is valid JSON whatever a client put into it. */
#include "server/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "proto/number.h"
#include "server/printable.h"
#include "server/thread.h"

#define LINE_RESERVE 2 /* brace, newline */
#define TEXT_LIMIT   512

#define GATHERED_MOST 65536
#define GATHER_NS     UINT64_C(10000000) /* a line is written so late at most */

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
    [' ' ... '!'] = true, ['#' ... '['] = true, [']' ... '~'] = true}; /* neither quote nor backslash */

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
        if (run ? !append(line, value, run) : !append_escape(line, (unsigned char)*value)) return false;
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

/* Appends ,"KEY":"VALUE" where all of the value can be written as it is, and has room; else nothing. */
static bool append_plain(struct server_log_line *line, const char *key, const char *value)
{
    size_t key_size = strlen(key), size = plain_run(value, TEXT_LIMIT);
    if (value[size] || line->size + key_size + size + 6 > sizeof line->text - LINE_RESERVE) return false;
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
    if (!append_key(line, key) || !append(line, "\"", 1) || !append_escaped(line, value) || !append(line, "\"", 1))
        line->size = start;
}

/* A key and its number's text. */
static void append_number(struct server_log_line *line, const char *key, const char *text, size_t size)
{
    size_t start = line->size;
    if (!append_key(line, key) || !append(line, text, size)) line->size = start;
}

void server_log_integer(struct server_log_line *line, const char *key, int64_t value)
{
    char text[PROTO_INTEGER_SIZE + 1] = "-";
    bool negative = value < 0;
    size_t size = proto_integer_print(negative ? 0 - (uint64_t)value : (uint64_t)value, text + negative);
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

/* --- to standard error --------------------------------------------------------------------------------------------
 *
 * Lines gather in one text while another one is being written, so that nobody who ends a line soon waits for the system
 * while there is room in it. */

/* Lines that are not written yet. */
static struct {
    pthread_mutex_t lock;
    struct server_thread *thread; /* writes them; NULL: nothing is gathered */
    bool is_awake;                /* the thread will write what is here */
    unsigned turn;                /* of the texts: they gather in this one */
    size_t size;
    char text[2][GATHERED_MOST];
} gathered = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* Whose it is has the other text. Taken before gathered.lock. */
static pthread_mutex_t writing = PTHREAD_MUTEX_INITIALIZER;

/* Takes the lines that have gathered. */
static const char *take_gathered(size_t *size)
{
    pthread_mutex_lock(&gathered.lock);
    const char *text = gathered.text[gathered.turn];
    *size = gathered.size;
    gathered.turn ^= 1;
    gathered.size = 0;
    pthread_mutex_unlock(&gathered.lock);
    return text;
}

/* There is nowhere to report a log that can't be written: what is left of it then is dropped. */
static void write_gathered(void)
{
    size_t size;
    ssize_t written = 1;
    pthread_mutex_lock(&writing);
    const char *text = take_gathered(&size);
    for (size_t at = 0; at < size && written > 0; at += (size_t)written)
        written = write(STDERR_FILENO, text + at, size - at);
    pthread_mutex_unlock(&writing);
}

/* Adds the line, under the lock, which it takes. */
static void gather(struct server_log_line *line)
{
    memcpy(line->text + line->size, "}\n", 2);
    line->size += 2;
    pthread_mutex_lock(&gathered.lock);
    while (line->size > GATHERED_MOST - gathered.size) {
        pthread_mutex_unlock(&gathered.lock);
        write_gathered();
        pthread_mutex_lock(&gathered.lock);
    }
    memcpy(gathered.text[gathered.turn] + gathered.size, line->text, line->size);
    gathered.size += line->size;
}

void server_log_end(struct server_log_line *line)
{
    gather(line);
    pthread_mutex_unlock(&gathered.lock);
    write_gathered();
}

void server_log_end_soon(struct server_log_line *line)
{
    gather(line);
    bool is_late = !gathered.thread;
    if (!is_late && !gathered.is_awake) server_thread_wake(gathered.thread);
    gathered.is_awake = !is_late;
    pthread_mutex_unlock(&gathered.lock);
    if (is_late) write_gathered();
}

/* Lets lines gather from the first one on. */
static void write_now_and_then(void *user, struct server_thread *thread)
{
    (void)user;
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER)) {
        (void)server_thread_sleep(thread, GATHER_NS);
        pthread_mutex_lock(&gathered.lock);
        gathered.is_awake = false;
        pthread_mutex_unlock(&gathered.lock);
        write_gathered();
    }
}

static struct server_thread *swap_thread(struct server_thread *thread)
{
    pthread_mutex_lock(&gathered.lock);
    struct server_thread *before = gathered.thread;
    gathered.thread = thread;
    gathered.is_awake = false;
    pthread_mutex_unlock(&gathered.lock);
    write_gathered();
    return before;
}

void server_log_start(void)
{
    swap_thread(server_thread_start(write_now_and_then, NULL));
}

void server_log_stop(void)
{
    server_thread_stop(swap_thread(NULL));
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
