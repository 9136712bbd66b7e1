/* Place: where and when threads run. Whatever the system refuses stays as it was. Figures:
 * server/doc/008.
 *
 * A thread that speaks HTTP comes a little before other programs, where the system lets it: a
 * client on the same machine whose answer has come would else take the core at every answer, which
 * costs both of them more than the answer does. While no worker is busy it has a core of its own,
 * if there are as many cores as such threads; else it goes where there is room: a worker's core
 * would be given up to it at the kernel's next tick only.
 *
 * Workers come after all others. Those that go behind have a core only while nobody else wants it;
 * who wakes up gets it from them at once, not at the kernel's next tick. */
#ifndef SERVER_WORK_THREAD_AFFINITY_H
#define SERVER_WORK_THREAD_AFFINITY_H

#include <stdbool.h>
#include <stdint.h>

/* of a thread that speaks HTTP: the least that any thread asks for */
#define SERVER_PLACE_NICE (-3)

/* Places the calling thread, one of so many that speak HTTP; to be called at each request.
 * `is_crowded`: workers are busy. */
void server_place_http(uint32_t threads, bool is_crowded, uint64_t now_ns);

/* Places the calling thread, a worker. */
void server_place_worker(void);

/* Puts the calling thread, a worker, behind all others (SCHED_IDLE), or back where workers are;
 * nothing happens where it could not come back. Costs nothing where it is already. */
void server_place_behind(bool wanted);

#endif
