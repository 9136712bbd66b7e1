#include "server/surfaces/scrub.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/surfaces/registry.h"

#define SECOND_NS UINT64_C(1000000000)
/* delay before the first round, so that the most used surfaces are loaded first */
#define FIRST_NS (60 * SECOND_NS)
#define LOOK_NS  (SECOND_NS / 20) /* time between two checks for running requests */
/* after this many checks the next piece is read even if requests run */
#define LOOKS 20

struct server_scrub {
    struct server_registry *registry;
    struct server_workers *workers;
    uint64_t period_ns, rate;
    /* both point to the thread; only the thread itself uses `self` */
    struct server_thread *thread, *self;
    uint32_t position, faults; /* position and faults of the current round */
    atomic_uint_least64_t bytes, files, rounds, last_faults;
    atomic_int_least64_t ended;
    _Atomic double progress;
};

/* Sleeps as long as the rate requires, and while requests run. Returns false if the scrub must
 * end. */
static bool scrub_on_piece(void *user, size_t bytes)
{
    struct server_scrub *scrub = user;
    double seconds = (double)bytes / (double)scrub->rate;
    atomic_fetch_add(&scrub->bytes, bytes);
    if (!server_thread_sleep(scrub->self, (uint64_t)(seconds * (double)SECOND_NS))) return false;
    for (int i = 0; i < LOOKS; i++) {
        struct server_workers_load load = server_workers_load(scrub->workers);
        if (load.running + load.queued == 0) break;
        if (!server_thread_sleep(scrub->self, LOOK_NS)) return false;
    }
    return true;
}

static void scrub_object(struct server_scrub *scrub, const struct server_record *record,
                         const struct server_object *object)
{
    static const char *const messages[SERVER_STORE_UNAVAILABLE + 1] = {
        [SERVER_STORE_DAMAGED] = "its stored file is damaged: its SHA-256 differs; upload "
                                 "it again, or restore a backup",
        [SERVER_STORE_ABSENT] = "its stored file is missing; upload it again, or restore a backup",
        [SERVER_STORE_REFUSED] = "its stored file can't be read; check the disk"};
    struct server_store *store = server_registry_store(scrub->registry);
    enum server_outcome outcome = store->verify(store, object, scrub_on_piece, scrub);
    struct server_log_line line;
    if (outcome && !messages[outcome]) return;
    atomic_fetch_add(&scrub->files, 1);
    if (!outcome) return;
    if (outcome == SERVER_STORE_ABSENT && !server_registry_is_current(scrub->registry, record))
        return;
    scrub->faults++;
    if (!server_log_begin(&line, SERVER_LOG_ERROR, "scrub_fault")) return;
    server_log_text(&line, "key", record->key);
    server_log_text(&line, "sha256", record->sha256);
    server_log_text(&line, "message", messages[outcome]);
    server_log_end(&line);
}

static void scrub_surface(struct server_scrub *scrub, const struct server_record *record)
{
    for (int part = 0; part < SERVER_PARTS; part++)
        if (record->objects[part].id[0]) scrub_object(scrub, record, &record->objects[part]);
    uint64_t count = server_registry_statistics(scrub->registry).surfaces;
    scrub->position++;
    atomic_store(&scrub->progress,
                 scrub->position < count ? (double)scrub->position / (double)count : 1);
}

static void scrub_round(struct server_scrub *scrub)
{
    uint64_t begun_ns = gd_now_ns();
    struct server_listed listed = {0};
    struct server_log_line line;
    scrub->position = scrub->faults = 0;
    atomic_store(&scrub->progress, 0);
    while (server_registry_next(scrub->registry, &listed)) {
        /* released so that the surface may be unloaded during the check */
        server_surface_release(listed.surface);
        listed.surface = NULL;
        scrub_surface(scrub, listed.record);
        if (server_thread_sleep(scrub->self, 0)) continue;
        server_listed_release(&listed);
        return;
    }
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

static void scrub_run(void *user, struct server_thread *thread)
{
    struct server_scrub *scrub = user;
    uint64_t wait_ns = scrub->period_ns < FIRST_NS ? scrub->period_ns : FIRST_NS;
    scrub->self = thread;
    while (server_thread_pause(thread, wait_ns)) {
        uint64_t begun_ns = gd_now_ns();
        scrub_round(scrub);
        uint64_t taken_ns = gd_now_ns() - begun_ns;
        wait_ns = taken_ns < scrub->period_ns ? scrub->period_ns - taken_ns : 0;
    }
}

struct server_scrub *server_scrub_create(struct server_registry *registry,
                                         struct server_workers *workers, uint64_t period_s,
                                         uint64_t rate)
{
    struct server_scrub *scrub = calloc(1, sizeof *scrub);
    if (!scrub) return NULL;
    scrub->registry = registry;
    scrub->workers = workers;
    scrub->period_ns = period_s * SECOND_NS;
    scrub->rate = rate;
    scrub->progress = 1;
    scrub->thread = server_thread_start(scrub_run, scrub);
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
    return (struct server_scrub_statistics){.bytes = scrub->bytes,
                                            .files = scrub->files,
                                            .rounds = scrub->rounds,
                                            .faults = scrub->last_faults,
                                            .ended = scrub->ended,
                                            .progress = scrub->progress};
}
