/* See log.h. A text is cut at TEXT_LIMIT inside its quotes, and a key whose value does not fit any more is left
 * out: so that every line is valid JSON whatever a client put into it. */
#include "server/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define LINE_RESERVE 2 /* brace, newline */
#define TEXT_LIMIT   512

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

static bool append_key(struct server_log_line *line, const char *key, const char *open)
{
    char prefix[80];
    int size = snprintf(prefix, sizeof prefix, ",\"%s\":%s", key, open);
    return append(line, prefix, (size_t)size);
}

static void append_escaped(struct server_log_line *line, const char *value)
{
    size_t end = line->size + TEXT_LIMIT;
    for (const unsigned char *c = (const unsigned char *)value; *c && line->size < end; c++) {
        char escaped[8];
        int size = *c < 0x20 || *c >= 0x7f   ? snprintf(escaped, sizeof escaped, "\\u%04x", *c)
                   : *c == '"' || *c == '\\' ? snprintf(escaped, sizeof escaped, "\\%c", *c)
                                             : snprintf(escaped, sizeof escaped, "%c", *c);
        if (!append(line, escaped, (size_t)size)) return;
    }
}

bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event)
{
    if (level < threshold) return false;
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    int size = snprintf(line->text, sizeof line->text,
                        "{\"time\":\"%04d-%02d-%02dT%02d:%02d:%02d.%03ldZ\",\"level\":\"%s\",\"event\":\"%s\"",
                        utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                        now.tv_nsec / 1000000, server_log_level_names[level], event);
    line->size = (size_t)size;
    return true;
}

void server_log_text(struct server_log_line *line, const char *key, const char *value)
{
    size_t start = line->size;
    if (!value || !append_key(line, key, "\"")) return;
    append_escaped(line, value);
    if (!append(line, "\"", 1)) line->size = start;
}

void server_log_integer(struct server_log_line *line, const char *key, int64_t value)
{
    char number[24];
    snprintf(number, sizeof number, "%lld", (long long)value);
    append_key(line, key, number);
}

void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds)
{
    char number[32];
    snprintf(number, sizeof number, "%.3f", (double)nanoseconds / 1e6);
    append_key(line, key, number);
}

void server_log_end(struct server_log_line *line)
{
    memcpy(line->text + line->size, "}\n", 2);
    ssize_t written = write(STDERR_FILENO, line->text, line->size + 2);
    (void)written; /* there is nowhere to report a log that can't be written */
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
