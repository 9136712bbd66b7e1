/* Deadlines: a thread that calls `tick` by the clock: every 10 milliseconds while requests are
 * deferred, every second while there is something to watch, else not at all. */
#ifndef SERVER_WORK_DEADLINES_H
#define SERVER_WORK_DEADLINES_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct server_thread;

struct server_deadlines {
    const atomic_uint *deferred; /* requests that wait or are under way */
    /* Answers the requests whose deadline has passed, drops what has expired. */
    void (*tick)(void *user, uint64_t now_ns);
    bool (*is_idle)(void *user); /* nothing to watch, besides deferred requests */
    void *user;
    struct server_thread *thread; /* set by start */
};

/* Starts the thread. False without memory or thread. */
bool server_deadlines_start(struct server_deadlines *deadlines);

/* The first request was deferred, or `is_idle` became false. */
void server_deadlines_wake(struct server_deadlines *deadlines);

/* Stops the thread; harmless if it was never started. */
void server_deadlines_stop(struct server_deadlines *deadlines);

#endif
