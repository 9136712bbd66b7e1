/* See timekeeper.h. */
#include "server/work/deadlines.h"

#include <stdlib.h>

#include "server/http/events.h"
#include "server/jobs/jobs.h"
#include "server/server.h"
#include "server/base/thread.h"

#define TICK_NS UINT64_C(10000000)   /* a deadline is answered so late at most */
#define LOOK_NS UINT64_C(1000000000) /* between two looks at ended jobs and idle streams */

struct server_timekeeper {
    struct server *server;
    struct server_thread *thread;
};

static void tick(struct server *server)
{
    uint64_t now = gd_now_ns();
    server_workers_expire(server->workers, now);
    server_cache_expire(server->surfaces.cache, now);
    server_loader_expire(server->surfaces.loader, now);
    server_registry_expire(server->surfaces.registry, now);
    if (server_workers_cancelled(server->workers))
        server_registry_cancel(server->surfaces.registry);
    server_jobs_sweep(server->jobs, now);
    server_events_tick(server->events, now);
}

static bool is_idle(const struct server *server)
{
    return server_jobs_is_empty(server->jobs) && server_events_count(server->events) == 0;
}

/* Until the next tick; while requests wait, whose number goes to and from zero all the time, wakes
 * don't hasten it. */
static bool rest(const struct server *server, struct server_thread *thread)
{
    if (atomic_load(&server->host.deferred)) return server_thread_sleep(thread, TICK_NS);
    return server_thread_pause(thread, is_idle(server) ? SERVER_THREAD_FOREVER : LOOK_NS);
}

static void keep_time(void *user, struct server_thread *thread)
{
    const struct server_timekeeper *timekeeper = user;
    while (rest(timekeeper->server, thread)) tick(timekeeper->server);
}

struct server_timekeeper *server_timekeeper_create(struct server *server)
{
    struct server_timekeeper *timekeeper = calloc(1, sizeof *timekeeper);
    if (!timekeeper) return NULL;
    timekeeper->server = server;
    timekeeper->thread = server_thread_start(keep_time, timekeeper);
    if (timekeeper->thread) return timekeeper;
    free(timekeeper);
    return NULL;
}

void server_timekeeper_wake(struct server_timekeeper *timekeeper)
{
    server_thread_wake(timekeeper->thread);
}

void server_timekeeper_destroy(struct server_timekeeper *timekeeper)
{
    if (!timekeeper) return;
    server_thread_stop(timekeeper->thread);
    free(timekeeper);
}
