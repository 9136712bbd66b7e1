/* See landmarks.h. */
#include "server/surfaces/landmarks.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/exchange/metrics.h"
#include "server/surfaces/field_store.h"

#define LEAST_FACES    2000 /* smaller meshes are searched in less than a tenth of a millisecond */
#define BYTES_AN_EDGE  256  /* of a build: 60 to 160, see doc/003 */
#define BYTES_A_BUILD  ((size_t)1 << 20)
#define BYTES_A_VERTEX (16 * sizeof(float) + sizeof(double)) /* landmarks, and choosing them */
#define LARGEST_PART   4  /* of the budget that a build may take */
#define PAUSE_FACTOR   10 /* of what the last job cost */
#define PAUSE_LEAST_NS UINT64_C(100000000)

struct server_landmarks {
    struct server_landmarks_parts parts;
    struct server_budget *budget;
    pthread_mutex_t lock;
    TAILQ_HEAD(, server_landmark_slot) by_use; /* the least recently used first */
    struct server_landmarks_statistics statistics;
    atomic_uint pressures; /* how often memory was short */
};

/* A job that builds or reads the set of a surface. */
struct landmark_job {
    struct server_job job; /* first */
    struct server_landmarks *owner;
    struct server_surface *surface;
    unsigned pressures; /* when it was submitted */
    uint64_t begun_ns;
    bool was_built, is_hopeless;
    struct gd_landmarks *landmarks; /* the result; its bytes are in flight */
};

/* --- slots, under the lock -------------------------------------------------------------------- */

/* Empties a slot; the caller releases the set, or NULL, without the lock. */
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

/* Takes over the landmarks (NULL is harmless) and their bytes, in flight so far. NULL without
 * memory: then both are released. */
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
    server_workers_refuse_background(landmarks->parts.workers, SERVER_REFUSAL_MEMORY);
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

/* --- the job ---------------------------------------------------------------------------------- */

/* Runs queued jobs first; false: the set is not wanted any more. */
static bool job_progress(void *user, double fraction)
{
    const struct landmark_job *job = user;
    struct server_workers *workers = job->owner->parts.workers;
    (void)fraction;
    server_workers_yield(workers);
    return server_workers_go_on(workers) && !atomic_load(&job->surface->landmarks.is_closed) &&
           atomic_load(&job->owner->pressures) == job->pressures;
}

static void job_build(struct landmark_job *job)
{
    const struct server_landmarks_parts *parts = &job->owner->parts;
    const struct gd_mesh_summary *summary = gd_mesh_summary(job->surface->mesh);
    struct server_budgeted_call call = {.workspaces = parts->workspaces,
                                        .control = {.progress = job_progress, .user = job},
                                        .grant =
                                            BYTES_A_BUILD + (size_t)summary->edges * BYTES_AN_EDGE,
                                        .aside = (size_t)summary->vertices * BYTES_A_VERTEX,
                                        .is_modest = true,
                                        .status = GD_BUDGET};
    bool is_affordable = call.grant + call.aside <= job->owner->budget->limit / LARGEST_PART;
    while (is_affordable && server_budgeted_call_next(&call)) {
        call.status =
            gd_landmarks_build(job->surface->mesh, parts->count, &call.control, &job->landmarks);
        if (!call.status) call.kept = gd_landmarks_memsize(job->landmarks);
    }
    job->was_built = true;
    job->is_hopeless = server_metrics_count_status(parts->metrics, call.status) || !is_affordable;
    if (!call.status && parts->field_store)
        server_field_store_write_landmarks(parts->field_store, parts->registry, job->surface,
                                           job->landmarks);
}

/* Puts the set (NULL: there is none) into the slot, and ends the job. */
static void job_end(struct landmark_job *job, struct server_landmark_set *set)
{
    struct server_landmarks *landmarks = job->owner;
    struct server_landmark_slot *slot = &job->surface->landmarks;
    pthread_mutex_lock(&landmarks->lock);
    slot->is_coming = false;
    slot->waiting = NULL;
    slot->cost_ns = job->begun_ns ? gd_now_ns() - job->begun_ns : 0;
    if (set) {
        slot->set = set;
        TAILQ_INSERT_TAIL(&landmarks->by_use, slot, by_use);
        *(job->was_built ? &landmarks->statistics.built : &landmarks->statistics.loaded) += 1;
    } else {
        slot_pause(slot);
        if (job->is_hopeless) slot->not_before_ns = UINT64_MAX;
    }
    pthread_mutex_unlock(&landmarks->lock);
    if (atomic_load(&slot->is_closed)) server_landmark_slot_close(slot);
    server_surface_release(job->surface);
    free(job);
}

static void job_run(struct server_job *base)
{
    struct landmark_job *job = (struct landmark_job *)base;
    const struct server_landmarks_parts *parts = &job->owner->parts;
    pthread_mutex_lock(&job->owner->lock);
    job->surface->landmarks.waiting = NULL;
    pthread_mutex_unlock(&job->owner->lock);
    job->begun_ns = gd_now_ns();
    if (parts->field_store)
        job->landmarks =
            server_field_store_read_landmarks(parts->field_store, job->surface, parts->count);
    if (!job->landmarks) job_build(job);
    job_end(job, set_create(job->owner->budget, job->landmarks));
}

static void job_refuse(struct server_job *base, enum server_refusal why)
{
    (void)why;
    job_end((struct landmark_job *)base, NULL);
}

static void job_submit(struct server_landmarks *landmarks, struct server_surface *surface)
{
    struct landmark_job *job = malloc(sizeof *job);
    if (!job) return; /* the surface does without */
    *job = (struct landmark_job){
        .job = {.run = job_run, .refuse = job_refuse, .deadline_ns = UINT64_MAX},
        .owner = landmarks,
        .surface = server_surface_retain(surface),
        .pressures = atomic_load(&landmarks->pressures)};
    pthread_mutex_lock(&landmarks->lock);
    surface->landmarks.waiting = &job->job;
    pthread_mutex_unlock(&landmarks->lock);
    server_workers_submit_background(landmarks->parts.workers, &job->job);
    if (atomic_load(&surface->landmarks.is_closed)) server_landmark_slot_close(&surface->landmarks);
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
    bool is_first = !set && !slot->is_coming && gd_now_ns() >= slot->not_before_ns;
    slot->is_coming |= is_first;
    if (set) {
        TAILQ_REMOVE(&landmarks->by_use, slot, by_use);
        TAILQ_INSERT_TAIL(&landmarks->by_use, slot, by_use);
        atomic_fetch_add(&set->references, 1);
    }
    pthread_mutex_unlock(&landmarks->lock);
    if (is_first) job_submit(landmarks, surface);
    return set;
}

void server_landmark_slot_close(struct server_landmark_slot *slot)
{
    atomic_store(&slot->is_closed, true);
    struct server_landmarks *landmarks = atomic_load(&slot->owner);
    if (!landmarks) return;
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_set *set = slot_empty(landmarks, slot);
    struct server_job *waiting = slot->waiting;
    if (waiting && !server_workers_withdraw(landmarks->parts.workers, waiting)) waiting = NULL;
    pthread_mutex_unlock(&landmarks->lock);
    server_landmark_set_release(set);
    /* the job holds the surface, which may be large */
    if (waiting) waiting->refuse(waiting, SERVER_REFUSAL_DRAINING);
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
    return landmarks;
}

void server_landmarks_destroy(struct server_landmarks *landmarks)
{
    if (!landmarks) return;
    landmarks->budget->reclaimers[SERVER_RECLAIM_LANDMARKS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&landmarks->lock);
    free(landmarks);
}

struct server_landmarks_statistics server_landmarks_statistics(struct server_landmarks *landmarks)
{
    struct server_landmarks_statistics statistics = {0};
    if (!landmarks) return statistics;
    pthread_mutex_lock(&landmarks->lock);
    statistics = landmarks->statistics;
    pthread_mutex_unlock(&landmarks->lock);
    return statistics;
}
