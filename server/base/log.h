/* Log: one JSON object per line on standard error.
 *
 *     struct server_log_line line;
 *     if (server_log_begin(&line, SERVER_LOG_INFO, "listening")) {
 *         server_log_text(&line, "address", address);
 *         server_log_end(&line);
 *     }
 *
 * A line is built on the caller's stack and written as a whole, so that lines of different threads
 * don't mix. Text is escaped and truncated so that each line is valid JSON. Thread-safe.
 *
 * DESIGN. Once started, the log never blocks and never fails a caller. Lines are copied, in order,
 * into a bounded buffer, and a thread writes them. If standard error is read too slowly, lines are
 * dropped, and a line `log_dropped` with their number takes their place. Standard error stays
 * blocking, because other processes share it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum server_log_level { SERVER_LOG_DEBUG, SERVER_LOG_INFO, SERVER_LOG_WARN, SERVER_LOG_ERROR };

/* Names of the levels ("debug" and so on), by level; NULL-terminated. */
extern const char *const server_log_levels[];

#define SERVER_LOG_LINE 2048

struct server_log_line {
    size_t size;
    char text[SERVER_LOG_LINE];
};

/* Lines below `level` are not logged. Call this function before any thread starts. */
void server_log_set_level(enum server_log_level level);

/* Begins a line with time, level and event. Returns false if the level is not logged; the caller
 * must then not use the line. */
bool server_log_begin(struct server_log_line *line, enum server_log_level level, const char *event);

/* Append a member, unless the line is full or `value` is NULL. */
void server_log_text(struct server_log_line *line, const char *key, const char *value);
void server_log_integer(struct server_log_line *line, const char *key, int64_t value);
void server_log_milliseconds(struct server_log_line *line, const char *key, uint64_t nanoseconds);

/* End the line. The thread writes it at once, or within 10 ms after server_log_end_soon. */
void server_log_end(struct server_log_line *line);
void server_log_end_soon(struct server_log_line *line);

/* Logs an event with one sentence. */
void server_log_message(enum server_log_level level, const char *event, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Start and stop the writing thread. server_log_start returns false if the thread can't be started.
 * Without the thread, each caller writes its own lines and waits at most 0.1 s. Stopping waits at
 * most 1 s for the last lines. */
bool server_log_start(void);
void server_log_stop(void);

/* Delays a crash, at most 0.2 s, until earlier lines are written. Call this function before threads
 * start. */
void server_log_flush_at_crash(void);

/* Returns the number of lines dropped since the start. Takes no lock. */
uint64_t server_log_dropped(void);
