/* Log: one JSON object a line on standard error.
 *
 *     struct server_log_line line;
 *     if (server_log_begin(&line, SERVER_LOG_INFO, "listening")) {
 *         server_log_text(&line, "address", address);
 *         server_log_end(&line);
 *     }
 *
 * A line is built in the caller's frame and written whole, so lines of different threads don't mix. Lines that tell of requests
 * may be written a little later, many at once: they stay in order, and only a crash loses them. Text is escaped and cut to
 * what fits; a log never fails a request. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* X(NAME, name), most talkative first */
#define SERVER_LOG_LEVELS(X) X(DEBUG, debug) X(INFO, info) X(WARN, warn) X(ERROR, error)

enum server_log_level {
#define SERVER_LOG_ENUM(NAME, name) SERVER_LOG_##NAME,
    SERVER_LOG_LEVELS(SERVER_LOG_ENUM)
#undef SERVER_LOG_ENUM
        SERVER_LOG_LEVEL_COUNT
};

#define SERVER_LOG_LINE 2048

struct server_log_line {
    size_t size;
    char text[SERVER_LOG_LINE];
};

extern const char *const server_log_level_names[SERVER_LOG_LEVEL_COUNT];

/* Lines below `level` are dropped. Set once, before any thread starts. */
void server_log_set_level(enum server_log_level level);

/* Begins a line with time, level and event; false when the level is not logged, and then nothing else is to be
 * called. */
bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event);
void server_log_text(struct server_log_line *line, const char *key,
                     const char *value); /* value NULL: the key is left out */
void server_log_integer(struct server_log_line *line, const char *key, int64_t value);
void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds);
void server_log_end(struct server_log_line *line);      /* writes it, after all those before it */
void server_log_end_soon(struct server_log_line *line); /* has it written within hundredths of a second */

/* From the start to the stop, lines that are ended soon gather, and a thread writes them; else they are written at once. */
void server_log_start(void);
void server_log_stop(void);

/* A whole line of an event and one sentence. */
void server_log_message(enum server_log_level level, const char *event, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
