/* See deadlines.h. */
#include "server/work/deadlines.h"

#include "gd/control.h"
#include "server/base/thread.h"

#define TICK_NS  UINT64_C(10000000)   /* the longest delay of a deadline */
#define WATCH_NS UINT64_C(1000000000) /* between two ticks without deferred requests */

/* While requests are deferred a wake doesn't hasten the tick: their number goes to and from zero
 * all the time. False: the thread is to end. */
static bool deadlines_wait(const struct server_deadlines *deadlines, struct server_thread *thread)
{
    if (atomic_load(deadlines->deferred)) return server_thread_sleep(thread, TICK_NS);
    bool is_idle = deadlines->is_idle(deadlines->user);
    return server_thread_pause(thread, is_idle ? SERVER_THREAD_FOREVER : WATCH_NS);
}

static void deadlines_run(void *user, struct server_thread *thread)
{
    const struct server_deadlines *deadlines = user;
    while (deadlines_wait(deadlines, thread)) deadlines->tick(deadlines->user, gd_now_ns());
}

bool server_deadlines_start(struct server_deadlines *deadlines)
{
    deadlines->thread = server_thread_start(deadlines_run, deadlines);
    return deadlines->thread != NULL;
}

void server_deadlines_wake(struct server_deadlines *deadlines)
{
    server_thread_wake(deadlines->thread);
}

void server_deadlines_stop(struct server_deadlines *deadlines)
{
    server_thread_stop(deadlines->thread);
    deadlines->thread = NULL;
}
