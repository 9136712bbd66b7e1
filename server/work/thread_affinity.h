/* Thread affinity: the core and the priority of HTTP threads. What the system refuses stays as it
 * was. Figures: server/doc/008.
 *
 * DESIGN. HTTP threads run a little before other programs: otherwise a client on the same machine
 * preempts them at every answer. While no worker is busy, each has a core of its own, if there are
 * as many cores as HTTP threads: the kernel often runs all of them on one core and their clients on
 * the other. While workers are busy, it may run on all cores: a worker would leave its core at the
 * next tick only. */
#ifndef SERVER_WORK_THREAD_AFFINITY_H
#define SERVER_WORK_THREAD_AFFINITY_H

#include <stdbool.h>
#include <stdint.h>

#define SERVER_HTTP_NICE (-3) /* the lowest nice value that a thread of the daemon asks for */

/* Places the calling thread, one of `threads` HTTP threads, for the request that it begins. */
void server_thread_place(uint32_t threads, bool are_workers_busy, uint64_t now_ns);

#endif
