/* Thread: background threads that work periodically until they are stopped; and locks.
 *
 *     static void run(void *user, struct server_thread *thread)
 *     {
 *         while (server_thread_pause(thread, SECOND_NS)) work(user);
 *     }
 *
 * A wake is never lost: a wake during the work ends the next pause at once. */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define SERVER_THREAD_FOREVER UINT64_MAX

/* Locks a mutex until the end of the block:
 *
 *     SERVER_LOCK(&table->lock);
 *     return table->count; */
#define SERVER_LOCK(mutex)                                                                         \
    __attribute__((cleanup(server_mutex_unlock))) pthread_mutex_t *const own_mutex = (mutex);      \
    pthread_mutex_lock(own_mutex)
#define SERVER_READ_LOCK(lock)                                                                     \
    __attribute__((cleanup(server_rwlock_unlock))) pthread_rwlock_t *const own_lock = (lock);      \
    pthread_rwlock_rdlock(own_lock)
#define SERVER_WRITE_LOCK(lock)                                                                    \
    __attribute__((cleanup(server_rwlock_unlock))) pthread_rwlock_t *const own_lock = (lock);      \
    pthread_rwlock_wrlock(own_lock)

static inline void server_mutex_unlock(pthread_mutex_t *const *mutex)
{
    pthread_mutex_unlock(*mutex);
}

static inline void server_rwlock_unlock(pthread_rwlock_t *const *lock)
{
    pthread_rwlock_unlock(*lock);
}

struct server_thread;

/* Starts a thread that calls `run` once. Returns NULL if there is no memory or no thread. */
struct server_thread *server_thread_start(void (*run)(void *user, struct server_thread *thread),
                                          void *user);

/* For `run`: waits until the thread is woken or `ns` nanoseconds have passed. Returns false if
 * `run` must end. */
bool server_thread_pause(struct server_thread *thread, uint64_t ns);

/* Like server_thread_pause, but a wake does not end this wait; it ends the next pause instead. */
bool server_thread_sleep(struct server_thread *thread, uint64_t ns);

/* Thread-safe. */
void server_thread_wake(struct server_thread *thread);

/* Makes pauses return false, waits until `run` returns, and frees the thread. NULL is allowed. */
void server_thread_stop(struct server_thread *thread);

/* Like server_thread_stop, but waits at most `ns` nanoseconds. Returns false if `run` has not
 * returned; then the thread frees itself when `run` returns. */
bool server_thread_stop_within(struct server_thread *thread, uint64_t ns);

/* Blocks the calling thread for that time. */
void server_pause(uint64_t ns);

/* Returns the processor time of the calling thread, in nanoseconds. */
uint64_t server_thread_cpu_ns(void);

/* Waits until the condition is signalled, or until a time on the clock of gd_now_ns;
 * SERVER_THREAD_FOREVER means no limit. The caller holds the lock. Returns false at a timeout. */
bool server_condition_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until_ns);
