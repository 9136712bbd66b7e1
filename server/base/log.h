/* Log: one JSON object a line on standard error.
 *
 *     struct server_log_line line;
 *     if (server_log_begin(&line, SERVER_LOG_INFO, "listening")) {
 *         server_log_text(&line, "address", address);
 *         server_log_end(&line);
 *     }
 *
 * A line is built in the caller's frame and written whole, so lines of different threads don't mix.
 * Text is escaped and cut to what fits.
 *
 * DESIGN. Once started, a log never waits and never fails a request: lines are copied into a
 * bounded buffer, in order, and a thread of its own writes them. If standard error is not read,
 * or too slowly, lines are dropped and counted, and where they are missing stands a line
 * `log_dropped` with their number. Standard error stays as it was inherited: it is blocking for
 * those that share it. */
#ifndef SERVER_BASE_LOG_H
#define SERVER_BASE_LOG_H

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

/* Begins a line with time, level and event; false when the level is not logged, and then nothing
 * else is to be called. */
bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event);
void server_log_text(struct server_log_line *line, const char *key,
                     const char *value); /* value NULL: the key is left out */
void server_log_integer(struct server_log_line *line, const char *key, int64_t value);
void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds);
/* has it written at once, after all those before it */
void server_log_end(struct server_log_line *line);
/* has it written within hundredths of a second */
void server_log_end_soon(struct server_log_line *line);

/* Starts the writer's thread; false: there is none. Before the start and after the stop a caller
 * writes its lines itself, and waits a tenth of a second at most. The stop waits a second at
 * most for the last lines to be written. */
bool server_log_start(void);
void server_log_stop(void);

/* Has a crash wait a moment for the lines before it to be written. Once, before any thread
 * starts. */
void server_log_flush_at_crash(void);

/* Lines that were dropped since the start. Thread-safe, takes no lock. */
uint64_t server_log_dropped(void);

/* A whole line of an event and one sentence. */
void server_log_message(enum server_log_level level, const char *event, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
