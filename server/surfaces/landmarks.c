#include "server/surfaces/landmarks.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/base/thread.h"
#include "server/exchange/metrics.h"
#include "server/surfaces/field_store.h"
#include "server/work/workers.h"

#define LEAST_FACES    2000 /* searching a smaller mesh takes less than 0.1 ms */
#define BYTES_AN_EDGE  256  /* bytes of a build for each edge; see server/doc/003 */
#define BYTES_A_BUILD  ((size_t)1 << 20)
#define BYTES_A_VERTEX (16 * sizeof(float) + sizeof(double)) /* landmarks, and choosing them */
#define LARGEST_PART   4  /* a build may take 1/4 of the budget */
#define PAUSE_FACTOR   10 /* times the cost of the last build */
#define PAUSE_LEAST_NS UINT64_C(100000000)
#define REST_NS        UINT64_C(10000000) /* a step takes about a millisecond */

struct server_landmarks {
    struct server_landmarks_parts parts;
    struct server_budget *budget;
    struct server_thread *thread;
    pthread_mutex_t lock;
    TAILQ_HEAD(, server_landmark_slot) by_use; /* the least recently used first */
    LIST_HEAD(, server_landmark_slot) waiting; /* the latest first */
    struct server_landmark_slot *building;     /* the slot whose set is built or read; or NULL */
    struct server_landmarks_statistics statistics;
    atomic_uint pressures; /* how often memory was short */
};

/* Builds or reads the set of a surface. */
struct build {
    struct server_landmarks *owner;
    struct server_surface *surface; /* a reference */
    unsigned pressures;             /* `landmarks->pressures` at the start */
    uint64_t begun_ns;
    bool was_built, is_hopeless;
    struct gd_landmarks *landmarks; /* the result; its bytes are in flight */
};

/* --- slots, under the lock -------------------------------------------------------------------- */

/* Empties a slot. Returns the set, or NULL, for the caller to release without the lock. */
static struct server_landmark_set *slot_empty(struct server_landmarks *landmarks,
                                              struct server_landmark_slot *slot)
{
    struct server_landmark_set *set = slot->set;
    if (set) TAILQ_REMOVE(&landmarks->by_use, slot, by_use);
    slot->set = NULL;
    return set;
}

static void slot_pause(struct server_landmark_slot *slot)
{
    uint64_t pause = PAUSE_FACTOR * slot->cost_ns;
    slot->not_before_ns = gd_now_ns() + (pause > PAUSE_LEAST_NS ? pause : PAUSE_LEAST_NS);
}

/* --- sets ------------------------------------------------------------------------------------- */

void server_landmark_set_release(struct server_landmark_set *set)
{
    if (!set || atomic_fetch_sub(&set->references, 1) != 1) return;
    gd_landmarks_release(set->landmarks);
    server_budget_give(set->budget, SERVER_BUDGET_LANDMARKS, set->bytes);
    free(set);
}

/* Makes a set: takes over the landmarks (NULL is harmless) and their bytes, so far in flight. NULL:
 * out of memory; then both are released. */
static struct server_landmark_set *set_create(struct server_budget *budget,
                                              struct gd_landmarks *landmarks)
{
    if (!landmarks) return NULL;
    struct server_landmark_set *set = malloc(sizeof *set);
    size_t bytes = gd_landmarks_memsize(landmarks);
    if (!set) {
        gd_landmarks_release(landmarks);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        return NULL;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_LANDMARKS, bytes);
    *set = (struct server_landmark_set){
        .references = 1, .landmarks = landmarks, .budget = budget, .bytes = bytes};
    return set;
}

static void landmarks_reclaim(void *user, size_t bytes)
{
    struct server_landmarks *landmarks = user;
    atomic_fetch_add(&landmarks->pressures, 1);
    for (size_t freed = 0; freed < bytes;) {
        pthread_mutex_lock(&landmarks->lock);
        struct server_landmark_slot *slot = TAILQ_FIRST(&landmarks->by_use);
        struct server_landmark_set *set = slot ? slot_empty(landmarks, slot) : NULL;
        if (slot) slot_pause(slot);
        landmarks->statistics.dropped += slot != NULL;
        pthread_mutex_unlock(&landmarks->lock);
        if (!set) return;
        freed += set->bytes;
        server_landmark_set_release(set);
    }
}

/* --- the thread ------------------------------------------------------------------------------- */

/* Sleeps while all workers are busy. False: the set is not needed any more. */
static bool build_progress(void *user, double fraction)
{
    const struct build *build = user;
    struct server_landmarks *landmarks = build->owner;
    struct server_workers_load load = server_workers_load(landmarks->parts.workers);
    (void)fraction;
    return server_thread_sleep(landmarks->thread, load.running < load.threads ? 0 : REST_NS) &&
           server_workers_go_on(landmarks->parts.workers) &&
           !atomic_load(&build->surface->landmarks.is_closed) &&
           atomic_load(&landmarks->pressures) == build->pressures;
}

static void build_run(struct build *build)
{
    const struct server_landmarks_parts *parts = &build->owner->parts;
    const struct gd_mesh_summary *summary = gd_mesh_summary(build->surface->mesh);
    struct server_budgeted_call call = {.workspaces = parts->workspaces,
                                        .control = {.progress = build_progress, .user = build},
                                        .grant =
                                            BYTES_A_BUILD + (size_t)summary->edges * BYTES_AN_EDGE,
                                        .aside = (size_t)summary->vertices * BYTES_A_VERTEX,
                                        .is_modest = true,
                                        .status = GD_BUDGET};
    bool is_affordable = call.grant + call.aside <= build->owner->budget->limit / LARGEST_PART;
    while (is_affordable && server_budgeted_call_next(&call)) {
        call.status = gd_landmarks_build(build->surface->mesh, parts->count, &call.control,
                                         &build->landmarks);
        if (!call.status) call.kept = gd_landmarks_memsize(build->landmarks);
    }
    build->was_built = true;
    build->is_hopeless = server_metrics_count_status(parts->metrics, call.status) || !is_affordable;
    if (!call.status && parts->field_store)
        server_field_store_write_landmarks(parts->field_store, parts->registry, build->surface,
                                           build->landmarks);
}

/* Puts the set (NULL: none) into the slot. */
static void build_end(struct build *build, struct server_landmark_set *set)
{
    struct server_landmarks *landmarks = build->owner;
    struct server_landmark_slot *slot = &build->surface->landmarks;
    pthread_mutex_lock(&landmarks->lock);
    bool is_kept = set && !atomic_load(&slot->is_closed);
    landmarks->building = NULL;
    slot->is_coming = false;
    slot->cost_ns = gd_now_ns() - build->begun_ns;
    if (is_kept) {
        slot->set = set;
        TAILQ_INSERT_TAIL(&landmarks->by_use, slot, by_use);
        *(build->was_built ? &landmarks->statistics.built : &landmarks->statistics.loaded) += 1;
    } else {
        slot_pause(slot);
        if (build->is_hopeless) slot->not_before_ns = UINT64_MAX;
    }
    pthread_mutex_unlock(&landmarks->lock);
    if (!is_kept) server_landmark_set_release(set);
    server_surface_release(build->surface);
}

/* Takes the most recently queued slot. False: there is none. */
static bool build_begin(struct server_landmarks *landmarks, struct build *build)
{
    SERVER_LOCK(&landmarks->lock);
    for (struct server_landmark_slot *slot; (slot = LIST_FIRST(&landmarks->waiting));) {
        LIST_REMOVE(slot, waiting);
        *build = (struct build){.owner = landmarks,
                                .surface = server_surface_of_slot(slot),
                                .pressures = atomic_load(&landmarks->pressures),
                                .begun_ns = gd_now_ns()};
        slot->is_coming = build->surface != NULL;
        landmarks->building = slot->is_coming ? slot : NULL;
        if (slot->is_coming) return true;
    }
    return false;
}

static void landmarks_run(void *user, struct server_thread *thread)
{
    struct server_landmarks *landmarks = user;
    const struct server_landmarks_parts *parts = &landmarks->parts;
    struct build build;
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER)) {
        server_workers_begin_guest(parts->workers);
        while (server_thread_sleep(thread, 0) && build_begin(landmarks, &build)) {
            if (parts->field_store)
                build.landmarks = server_field_store_read_landmarks(parts->field_store,
                                                                    build.surface, parts->count);
            if (!build.landmarks) build_run(&build);
            build_end(&build, set_create(landmarks->budget, build.landmarks));
        }
        server_workers_end_guest(parts->workers);
    }
}

/* --- finding ---------------------------------------------------------------------------------- */

struct server_landmark_set *server_landmarks_find(struct server_landmarks *landmarks,
                                                  struct server_surface *surface)
{
    struct server_landmark_slot *slot = &surface->landmarks;
    if (!landmarks || gd_mesh_summary(surface->mesh)->faces < LEAST_FACES ||
        atomic_load(&slot->is_closed))
        return NULL;
    atomic_store(&slot->owner, landmarks);
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_set *set = slot->set;
    bool is_wanted = !set && !slot->is_coming && !atomic_load(&slot->is_closed) &&
                     gd_now_ns() >= slot->not_before_ns;
    if (is_wanted) {
        slot->is_coming = true;
        LIST_INSERT_HEAD(&landmarks->waiting, slot, waiting);
    }
    if (set) {
        TAILQ_REMOVE(&landmarks->by_use, slot, by_use);
        TAILQ_INSERT_TAIL(&landmarks->by_use, slot, by_use);
        atomic_fetch_add(&set->references, 1);
    }
    pthread_mutex_unlock(&landmarks->lock);
    if (is_wanted) server_thread_wake(landmarks->thread);
    return set;
}

void server_landmark_slot_close(struct server_landmark_slot *slot)
{
    atomic_store(&slot->is_closed, true);
    struct server_landmarks *landmarks = atomic_load(&slot->owner);
    if (!landmarks) return;
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_set *set = slot_empty(landmarks, slot);
    if (slot->is_coming && slot != landmarks->building) {
        LIST_REMOVE(slot, waiting);
        slot->is_coming = false;
    }
    pthread_mutex_unlock(&landmarks->lock);
    server_landmark_set_release(set);
}

struct server_landmarks *server_landmarks_create(const struct server_landmarks_parts *parts)
{
    struct server_landmarks *landmarks = calloc(1, sizeof *landmarks);
    if (!landmarks) return NULL;
    landmarks->parts = *parts;
    landmarks->budget = server_workspaces_budget(parts->workspaces);
    pthread_mutex_init(&landmarks->lock, NULL);
    TAILQ_INIT(&landmarks->by_use);
    landmarks->budget->reclaimers[SERVER_RECLAIM_LANDMARKS] =
        (struct server_reclaimer){landmarks_reclaim, NULL, landmarks};
    landmarks->thread = server_thread_start(landmarks_run, landmarks);
    if (landmarks->thread) return landmarks;
    server_landmarks_destroy(landmarks);
    return NULL;
}

void server_landmarks_stop(struct server_landmarks *landmarks)
{
    if (!landmarks) return;
    server_thread_stop(landmarks->thread);
    landmarks->thread = NULL;
}

void server_landmarks_destroy(struct server_landmarks *landmarks)
{
    if (!landmarks) return;
    server_landmarks_stop(landmarks);
    landmarks->budget->reclaimers[SERVER_RECLAIM_LANDMARKS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&landmarks->lock);
    free(landmarks);
}

struct server_landmarks_statistics server_landmarks_statistics(struct server_landmarks *landmarks)
{
    struct server_landmarks_statistics statistics = {0};
    if (!landmarks) return statistics;
    SERVER_LOCK(&landmarks->lock);
    statistics = landmarks->statistics;
    statistics.is_building = landmarks->building || !LIST_EMPTY(&landmarks->waiting);
    return statistics;
}
