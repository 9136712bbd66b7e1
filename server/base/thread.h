/* Thread: a background thread that works now and then until it is stopped.
 *
 *     static void run(void *user, struct server_thread *thread)
 *     {
 *         while (server_thread_pause(thread, SECOND_NS)) look_after(user);
 *     }
 *
 * A wake is never lost: one that comes while the thread works ends its next pause. */
#ifndef SERVER_BASE_THREAD_H
#define SERVER_BASE_THREAD_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define SERVER_THREAD_FOREVER UINT64_MAX

struct server_thread;

/* Starts a thread that calls `run` once. NULL without memory or thread. */
struct server_thread *server_thread_start(void (*run)(void *user, struct server_thread *thread),
                                          void *user);

/* For `run`: waits until the thread is woken or `ns` nanoseconds have passed (monotonic clock).
 * Returns false, at once, when `run` must return. */
bool server_thread_pause(struct server_thread *thread, uint64_t ns);

/* The same, but a wake ends the next pause instead. */
bool server_thread_sleep(struct server_thread *thread, uint64_t ns);

/* Thread-safe. */
void server_thread_wake(struct server_thread *thread);

/* Ends the pauses, waits for `run` to return, and frees. NULL is harmless. */
void server_thread_stop(struct server_thread *thread);

/* The same, but waits `ns` nanoseconds at most. False: `run` has not returned; the thread is left
 * behind, and frees itself if `run` returns later. */
bool server_thread_stop_within(struct server_thread *thread, uint64_t ns);

/* Under the lock, which it releases meanwhile: waits for a signal until a time of gd_now_ns, or
 * SERVER_THREAD_FOREVER. False: the time has come. */
bool server_condition_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until_ns);

#endif
