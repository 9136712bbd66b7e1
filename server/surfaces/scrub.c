/* See scrub.h. */
#include "server/surfaces/scrub.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "server/base/log.h"
#include "server/server.h"
#include "server/base/thread.h"

#define SECOND_NS UINT64_C(1000000000)
/* from the start to the first round: the most used surfaces are loaded then */
#define FIRST_NS (60 * SECOND_NS)
#define LOOK_NS  (SECOND_NS / 20) /* between two looks whether requests are at work */
#define LOOKS    20               /* after which a piece is read in any case */

struct server_scrub {
    struct server *server;
    struct server_thread *thread, *self; /* the same; `self` is for the thread itself */
    uint32_t position, faults;           /* in the round under way */
    atomic_uint_least64_t bytes, files, rounds, last_faults;
    atomic_int_least64_t ended; /* when the last whole round did, seconds since 1970 */
    _Atomic double progress;    /* of the round under way, in [0,1]; 1 between rounds */
};

/* --- how fast --------------------------------------------------------------------------------- */

static bool is_busy(const struct server *server)
{
    struct server_workers_load load = server_workers_load(server->workers);
    return load.running + load.queued > 0;
}

/* False: the scrub is to end. */
static bool pace(void *user, size_t bytes)
{
    struct server_scrub *scrub = user;
    const struct server *server = scrub->server;
    atomic_fetch_add(&scrub->bytes, bytes);
    double seconds = (double)bytes / (double)server->config.scrub_rate;
    if (!server_thread_sleep(scrub->self, (uint64_t)(seconds * (double)SECOND_NS))) return false;
    for (int i = 0; i < LOOKS && is_busy(server); i++)
        if (!server_thread_sleep(scrub->self, LOOK_NS)) return false;
    return true;
}

/* --- one surface ------------------------------------------------------------------------------ */

static const char *const complaints[] = {
    [SERVER_VERDICT_DAMAGED] = "its stored file is damaged: its SHA-256 is another one; upload it "
                               "again, or restore a backup",
    [SERVER_VERDICT_MISSING] = "its stored file is missing; upload it again, or restore a backup",
    [SERVER_VERDICT_UNREADABLE] = "its stored file can't be read; look after the disk"};

static void complain(const struct server_record *record, enum server_store_verdict verdict)
{
    struct server_log_line line;
    if (!server_log_begin(&line, SERVER_LOG_ERROR, "scrub_fault")) return;
    server_log_text(&line, "key", record->key);
    server_log_text(&line, "sha256", record->sha256);
    server_log_text(&line, "message", complaints[verdict]);
    server_log_end(&line);
}

static void look_at(struct server_scrub *scrub, const struct server_record *record,
                    enum server_part part)
{
    struct server *server = scrub->server;
    enum server_store_verdict verdict =
        server_registry_verify(server->registry, record, part, pace, scrub);
    if (verdict == SERVER_VERDICT_NONE) return;
    atomic_fetch_add(&scrub->files, 1);
    if (verdict == SERVER_VERDICT_SOUND || (verdict == SERVER_VERDICT_MISSING &&
                                            !server_registry_is_current(server->registry, record)))
        return;
    scrub->faults++;
    complain(record, verdict);
}

/* --- rounds ----------------------------------------------------------------------------------- */

/* The surface after that one (NULL: the first), its record retained; NULL: there is none. Takes
 * `before` over. */
static struct server_record *next_of(struct server *server, struct server_record *before)
{
    struct server_listed listed = {0};
    struct server_key key = {0};
    if (before) key = server_record_key(before);
    uint32_t found = server_registry_list_all(server->registry, before ? &key : NULL, 1, &listed);
    server_record_release(before);
    if (!found) return NULL;
    server_surface_release(listed.surface);
    return listed.record;
}

static void note_progress(struct server_scrub *scrub)
{
    uint64_t count = server_registry_statistics(scrub->server->registry).surfaces;
    scrub->position++;
    atomic_store(&scrub->progress,
                 scrub->position < count ? (double)scrub->position / (double)count : 1);
}

static void end_round(struct server_scrub *scrub, uint64_t begun_ns)
{
    struct server_log_line line;
    atomic_fetch_add(&scrub->rounds, 1);
    atomic_store(&scrub->last_faults, scrub->faults);
    atomic_store(&scrub->ended, time(NULL));
    atomic_store(&scrub->progress, 1);
    if (!server_log_begin(&line, SERVER_LOG_INFO, "scrubbed")) return;
    server_log_integer(&line, "surfaces", scrub->position);
    server_log_integer(&line, "faults", scrub->faults);
    server_log_milliseconds(&line, "ms", gd_now_ns() - begun_ns);
    server_log_end(&line);
}

/* All that is stored. False: the scrub is to end. */
static bool go_round(struct server_scrub *scrub)
{
    uint64_t begun_ns = gd_now_ns();
    scrub->position = scrub->faults = 0;
    atomic_store(&scrub->progress, 0);
    struct server_record *record = NULL;
    struct server_object object;
    while ((record = next_of(scrub->server, record))) {
        for (int part = 0; part < SERVER_PARTS; part++)
            if (server_record_object(record, part, &object)) look_at(scrub, record, part);
        note_progress(scrub);
        if (server_thread_sleep(scrub->self, 0)) continue;
        server_record_release(record);
        return false;
    }
    end_round(scrub, begun_ns);
    return true;
}

static void run(void *user, struct server_thread *thread)
{
    struct server_scrub *scrub = user;
    scrub->self = thread;
    uint64_t period_ns = scrub->server->config.scrub_s * SECOND_NS;
    uint64_t wait_ns = period_ns < FIRST_NS ? period_ns : FIRST_NS;
    while (server_thread_pause(thread, wait_ns)) {
        uint64_t begun_ns = gd_now_ns();
        if (!go_round(scrub)) return;
        uint64_t taken_ns = gd_now_ns() - begun_ns;
        wait_ns = taken_ns < period_ns ? period_ns - taken_ns : 0;
    }
}

/* --- from the outside ------------------------------------------------------------------------- */

struct server_scrub *server_scrub_create(struct server *server)
{
    struct server_scrub *scrub = calloc(1, sizeof *scrub);
    if (!scrub) return NULL;
    scrub->server = server;
    scrub->progress = 1;
    scrub->thread = server_thread_start(run, scrub);
    if (scrub->thread) return scrub;
    free(scrub);
    return NULL;
}

void server_scrub_destroy(struct server_scrub *scrub)
{
    if (!scrub) return;
    server_thread_stop(scrub->thread);
    free(scrub);
}

struct server_scrub_statistics server_scrub_statistics(const struct server_scrub *scrub)
{
    return (struct server_scrub_statistics){.bytes = atomic_load(&scrub->bytes),
                                            .files = atomic_load(&scrub->files),
                                            .rounds = atomic_load(&scrub->rounds),
                                            .faults = atomic_load(&scrub->last_faults),
                                            .ended = atomic_load(&scrub->ended),
                                            .progress = atomic_load(&scrub->progress)};
}
