/* See landmarks.h. */
#include "server/surfaces/landmarks.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/server.h"
#include "server/work/budgeted_call.h"
#include "server/surfaces/field_store.h"

#define LEAST_FACES   2000 /* smaller meshes are searched in less than a tenth of a millisecond */
#define BYTES_AN_EDGE 256  /* of a build: 60 to 160, see doc/003 */
#define BYTES_A_BUILD ((size_t)1 << 20)
/* the landmarks, and what chooses them */
#define BYTES_A_VERTEX (16 * sizeof(float) + sizeof(double))
/* of the budget: what a build may take, so that requests that come meanwhile have the rest */
#define LARGEST_PART   4
#define PAUSE_FACTOR   10 /* of what it cost to have had them */
#define PAUSE_LEAST_NS UINT64_C(100000000)

struct server_landmarks {
    struct server *server;
    pthread_mutex_t lock;
    struct server_landmark_slot *coldest, *warmest;
    struct server_landmarks_statistics statistics;
    atomic_uint pressures; /* how often memory was short */
};

/* One surface's set on its way. */
struct bringing {
    struct server_job job; /* first */
    struct server_landmarks *owner;
    struct server_surface *surface;
    unsigned pressures; /* when it was submitted */
    uint64_t begun_ns;
    bool was_built, is_hopeless;
};

/* --- sets ------------------------------------------------------------------------------------- */

void server_landmark_set_release(struct server_landmark_set *set)
{
    if (!set || atomic_fetch_sub(&set->references, 1) != 1) return;
    gd_landmarks_release(set->landmarks);
    server_budget_give(set->budget, SERVER_BUDGET_LANDMARKS, set->bytes);
    free(set);
}

/* Takes over the landmarks and their bytes, in flight so far. NULL without memory: both are gone.
 */
static struct server_landmark_set *create_set(struct server_budget *budget,
                                              struct gd_landmarks *landmarks)
{
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

/* --- slots in the order of use, under the lock ------------------------------------------------ */

static void link_warmest(struct server_landmarks *landmarks, struct server_landmark_slot *slot)
{
    slot->warmer = NULL;
    slot->colder = landmarks->warmest;
    *(slot->colder ? &slot->colder->warmer : &landmarks->coldest) = slot;
    landmarks->warmest = slot;
}

static void unlink_slot(struct server_landmarks *landmarks, struct server_landmark_slot *slot)
{
    *(slot->colder ? &slot->colder->warmer : &landmarks->coldest) = slot->warmer;
    *(slot->warmer ? &slot->warmer->colder : &landmarks->warmest) = slot->colder;
}

/* The set that the slot had, whose reference is the caller's to release after the lock; NULL: it
 * was empty. */
static struct server_landmark_set *empty(struct server_landmarks *landmarks,
                                         struct server_landmark_slot *slot)
{
    struct server_landmark_set *set = slot->set;
    if (set) unlink_slot(landmarks, slot);
    slot->set = NULL;
    return set;
}

static void pause_slot(struct server_landmark_slot *slot)
{
    uint64_t pause = PAUSE_FACTOR * slot->cost_ns;
    slot->not_before_ns = gd_now_ns() + (pause > PAUSE_LEAST_NS ? pause : PAUSE_LEAST_NS);
}

/* --- under pressure --------------------------------------------------------------------------- */

/* The set that was not used for longest; NULL: there is none. */
static struct server_landmark_set *drop_coldest(struct server_landmarks *landmarks)
{
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_slot *slot = landmarks->coldest;
    struct server_landmark_set *set = slot ? empty(landmarks, slot) : NULL;
    if (slot) pause_slot(slot);
    landmarks->statistics.dropped += slot != NULL;
    pthread_mutex_unlock(&landmarks->lock);
    return set;
}

static void reclaim(void *user, size_t bytes)
{
    struct server_landmarks *landmarks = user;
    struct server_landmark_set *set;
    atomic_fetch_add(&landmarks->pressures, 1);
    server_workers_refuse_background(landmarks->server->workers, SERVER_REFUSAL_MEMORY);
    for (size_t freed = 0; freed < bytes && (set = drop_coldest(landmarks));
         server_landmark_set_release(set))
        freed += set->bytes;
}

/* --- bringing a set --------------------------------------------------------------------------- */

/* Runs what is queued first; false: the set is not wanted any more. */
static bool on_progress(void *user, double fraction)
{
    const struct bringing *bringing = user;
    struct server_workers *workers = bringing->owner->server->workers;
    (void)fraction;
    server_workers_yield(workers);
    return server_workers_go_on(workers) && !atomic_load(&bringing->surface->landmarks.is_closed) &&
           atomic_load(&bringing->owner->pressures) == bringing->pressures;
}

struct wanted {
    const struct gd_mesh *mesh;
    uint32_t count;
    struct gd_landmarks *out;
};

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct wanted *wanted = user;
    enum gd_status status = gd_landmarks_build(wanted->mesh, wanted->count, control, &wanted->out);
    if (!status) *kept = gd_landmarks_memsize(wanted->out);
    return status;
}

/* Their bytes are in flight. NULL: not now. */
static struct gd_landmarks *build_landmarks(struct bringing *bringing)
{
    struct server *server = bringing->owner->server;
    struct wanted wanted = {.mesh = bringing->surface->mesh,
                            .count = (uint32_t)server->config.landmarks};
    const struct gd_mesh_summary *summary = gd_mesh_summary(wanted.mesh);
    const struct server_budgeted_call call = {
        .make = build,
        .user = &wanted,
        .control = {.progress = on_progress, .user = bringing},
        .grant = BYTES_A_BUILD + (size_t)summary->edges * BYTES_AN_EDGE,
        .aside = (size_t)summary->vertices * BYTES_A_VERTEX,
        .is_modest = true};
    bool is_affordable = call.grant + call.aside <= server->budget.limit / LARGEST_PART;
    enum gd_status status =
        is_affordable ? server_budgeted_call_run(server->workspaces, &call) : GD_BUDGET;
    bringing->is_hopeless = server_metrics_count_status(server->metrics, status) || !is_affordable;
    if (status) return NULL;
    if (server->fields)
        server_field_store_write_landmarks(server->fields, server->registry, bringing->surface,
                                           wanted.out);
    return wanted.out;
}

static struct gd_landmarks *read_or_build(struct bringing *bringing)
{
    struct server *server = bringing->owner->server;
    struct gd_landmarks *landmarks = NULL;
    if (server->fields)
        landmarks = server_field_store_read_landmarks(server->fields, bringing->surface,
                                                      (uint32_t)server->config.landmarks);
    bringing->was_built = !landmarks;
    return landmarks ? landmarks : build_landmarks(bringing);
}

/* Puts the set (NULL: it did not come) into the slot, and ends the job. */
static void finish(struct bringing *bringing, struct server_landmark_set *set)
{
    struct server_landmarks *landmarks = bringing->owner;
    struct server_landmark_slot *slot = &bringing->surface->landmarks;
    pthread_mutex_lock(&landmarks->lock);
    slot->is_coming = false;
    slot->waiting = NULL;
    slot->cost_ns = bringing->begun_ns ? gd_now_ns() - bringing->begun_ns : 0;
    if (set) {
        slot->set = set;
        link_warmest(landmarks, slot);
        *(bringing->was_built ? &landmarks->statistics.built : &landmarks->statistics.loaded) += 1;
    } else {
        pause_slot(slot);
        if (bringing->is_hopeless) slot->not_before_ns = UINT64_MAX;
    }
    pthread_mutex_unlock(&landmarks->lock);
    if (atomic_load(&slot->is_closed)) server_landmark_slot_close(slot);
    server_surface_release(bringing->surface);
    free(bringing);
}

static void run(struct server_job *job)
{
    struct bringing *bringing = (struct bringing *)job;
    pthread_mutex_lock(&bringing->owner->lock);
    bringing->surface->landmarks.waiting = NULL;
    pthread_mutex_unlock(&bringing->owner->lock);
    bringing->begun_ns = gd_now_ns();
    struct gd_landmarks *landmarks = read_or_build(bringing);
    finish(bringing, landmarks ? create_set(&bringing->owner->server->budget, landmarks) : NULL);
}

static void refuse(struct server_job *job, enum server_refusal why)
{
    (void)why;
    finish((struct bringing *)job, NULL);
}

static void bring(struct server_landmarks *landmarks, struct server_surface *surface)
{
    struct bringing *bringing = malloc(sizeof *bringing);
    if (!bringing) return; /* the surface does without */
    *bringing = (struct bringing){.job = {.run = run, .refuse = refuse, .deadline_ns = UINT64_MAX},
                                  .owner = landmarks,
                                  .surface = server_surface_retain(surface),
                                  .pressures = atomic_load(&landmarks->pressures)};
    pthread_mutex_lock(&landmarks->lock);
    surface->landmarks.waiting = &bringing->job;
    pthread_mutex_unlock(&landmarks->lock);
    server_workers_submit_background(landmarks->server->workers, &bringing->job);
    /* meanwhile */
    if (atomic_load(&surface->landmarks.is_closed)) server_landmark_slot_close(&surface->landmarks);
}

/* --- from the outside ------------------------------------------------------------------------- */

/* The slot's set as the one used last; else true in `*is_first` for the one who is to bring it. */
static struct server_landmark_set *use(struct server_landmarks *landmarks,
                                       struct server_landmark_slot *slot, bool *is_first)
{
    *is_first = !slot->set && !slot->is_coming && gd_now_ns() >= slot->not_before_ns;
    slot->is_coming |= *is_first;
    if (!slot->set) return NULL;
    unlink_slot(landmarks, slot);
    link_warmest(landmarks, slot);
    atomic_fetch_add(&slot->set->references, 1);
    return slot->set;
}

struct server_landmark_set *server_landmarks_find(struct server_landmarks *landmarks,
                                                  struct server_surface *surface)
{
    struct server_landmark_slot *slot = &surface->landmarks;
    bool is_first;
    if (!landmarks || gd_mesh_summary(surface->mesh)->faces < LEAST_FACES ||
        atomic_load(&slot->is_closed))
        return NULL;
    atomic_store(&slot->owner, landmarks);
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_set *set = use(landmarks, slot, &is_first);
    pthread_mutex_unlock(&landmarks->lock);
    if (is_first) bring(landmarks, surface);
    return set;
}

void server_landmark_slot_close(struct server_landmark_slot *slot)
{
    atomic_store(&slot->is_closed, true);
    struct server_landmarks *landmarks = atomic_load(&slot->owner);
    if (!landmarks) return;
    pthread_mutex_lock(&landmarks->lock);
    struct server_landmark_set *set = empty(landmarks, slot);
    struct server_job *waiting = slot->waiting;
    if (waiting && !server_workers_withdraw(landmarks->server->workers, waiting)) waiting = NULL;
    pthread_mutex_unlock(&landmarks->lock);
    server_landmark_set_release(set);
    /* it holds the surface, which may be large */
    if (waiting) waiting->refuse(waiting, SERVER_REFUSAL_DRAINING);
}

struct server_landmarks *server_landmarks_create(struct server *server)
{
    struct server_landmarks *landmarks = calloc(1, sizeof *landmarks);
    if (!landmarks) return NULL;
    pthread_mutex_init(&landmarks->lock, NULL);
    landmarks->server = server;
    server->budget.reclaimers[SERVER_RECLAIM_LANDMARKS] =
        (struct server_reclaimer){reclaim, NULL, landmarks};
    return landmarks;
}

void server_landmarks_destroy(struct server_landmarks *landmarks)
{
    if (!landmarks) return;
    landmarks->server->budget.reclaimers[SERVER_RECLAIM_LANDMARKS] = (struct server_reclaimer){0};
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
