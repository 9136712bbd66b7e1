#include "server/surfaces/landmarks.h"

#include <stdlib.h>

#include "server/base/thread.h"
#include "server/exchange/metrics.h"
#include "server/surfaces/field_store.h"

/* a search on a smaller mesh takes less than 0.1 ms without landmarks */
#define LEAST_FACES   2000
#define BYTES_AN_EDGE 256 /* bytes of a build for each edge; see server/doc/003 */
#define BYTES_A_BUILD ((size_t)1 << 20)
/* the landmarks, and the distances to choose them */
#define BYTES_A_VERTEX (32 * sizeof(uint16_t) + sizeof(double))
#define LARGEST_PART   4  /* a build may take at most 1/4 of the budget */
#define PAUSE_FACTOR   10 /* pause before a rebuild, in multiples of the time of the last build */
#define PAUSE_LEAST_NS UINT64_C(100000000)

struct server_landmarks {
    struct server_background background; /* must be the first member */
    struct server_metrics *metrics;
    uint32_t count;
    struct server_landmarks_statistics statistics; /* under the lock */
    /* used by the thread, for the current build: */
    uint64_t begun_ns;
    bool was_built, is_hopeless;
};

static void slot_pause(struct server_landmark_slot *slot)
{
    uint64_t pause = PAUSE_FACTOR * slot->cost_ns;
    slot->not_before_ns = gd_now_ns() + (pause > PAUSE_LEAST_NS ? pause : PAUSE_LEAST_NS);
}

static void set_on_eviction(struct server_lru *lru, struct server_lru_item **place)
{
    slot_pause((struct server_landmark_slot *)((char *)place -
                                               offsetof(struct server_landmark_slot, base.item)));
    ((struct server_landmarks *)lru)->statistics.dropped++;
}

static void set_free(struct server_lru_item *item)
{
    gd_landmarks_release(((struct server_landmark_set *)item)->landmarks);
    free(item);
}

void server_landmark_set_release(struct server_landmark_set *set)
{
    if (set) server_lru_release(&set->item);
}

/* --- the thread ------------------------------------------------------------------------------- */

/* Builds the landmarks. Their bytes are then counted in SERVER_BUDGET_FLIGHT. Returns NULL on
 * failure. */
static struct gd_landmarks *landmarks_build(struct server_landmarks *landmarks,
                                            struct server_build *build)
{
    const struct server_background_parts *parts = &landmarks->background.parts;
    const struct gd_mesh_summary *summary = gd_mesh_summary(build->surface->mesh);
    struct gd_landmarks *built = NULL;
    struct server_budgeted_call call =
        server_build_begin_call(build, BYTES_A_BUILD + (size_t)summary->edges * BYTES_AN_EDGE);
    call.aside = (size_t)summary->vertices * BYTES_A_VERTEX;
    bool is_affordable =
        call.grant + call.aside <= landmarks->background.lru.budget->limit / LARGEST_PART;
    while (is_affordable && server_budgeted_call_next(&call)) {
        call.status =
            gd_landmarks_build(build->surface->mesh, landmarks->count, &call.control, &built);
        if (!call.status) call.kept = gd_landmarks_memsize(built);
    }
    landmarks->is_hopeless =
        server_metrics_count_status(landmarks->metrics, call.status) || !is_affordable;
    if (call.status) return NULL;
    if (parts->field_store)
        server_field_store_write_landmarks(parts->field_store, parts->registry, build->surface,
                                           built);
    return built;
}

static struct server_lru_item *set_make(struct server_build *build)
{
    struct server_landmarks *landmarks = (struct server_landmarks *)build->background;
    struct server_field_store *store = build->background->parts.field_store;
    landmarks->begun_ns = gd_now_ns();
    landmarks->is_hopeless = false;
    struct gd_landmarks *made =
        store ? server_field_store_read_landmarks(store, build->surface, landmarks->count) : NULL;
    landmarks->was_built = !made;
    if (!made) made = landmarks_build(landmarks, build);
    if (!made) return NULL;
    size_t bytes = gd_landmarks_memsize(made);
    struct server_landmark_set *set = malloc(sizeof *set);
    if (!set) {
        gd_landmarks_release(made);
        server_budget_give(build->background->lru.budget, SERVER_BUDGET_FLIGHT, bytes);
        return NULL;
    }
    set->landmarks = made;
    server_lru_adopt(&build->background->lru, &set->item, bytes);
    return &set->item;
}

static void set_on_end(const struct server_build *build, bool is_kept)
{
    struct server_landmarks *landmarks = (struct server_landmarks *)build->background;
    struct server_landmark_slot *slot = &build->surface->landmarks;
    slot->cost_ns = gd_now_ns() - landmarks->begun_ns;
    if (is_kept) {
        *(landmarks->was_built ? &landmarks->statistics.built : &landmarks->statistics.loaded) += 1;
    } else {
        slot_pause(slot);
        if (landmarks->is_hopeless) slot->not_before_ns = UINT64_MAX;
    }
}

/* --- finding ---------------------------------------------------------------------------------- */

struct server_landmark_set *server_landmarks_find(struct server_background *landmarks,
                                                  struct server_surface *surface)
{
    struct server_landmark_slot *slot = &surface->landmarks;
    if (!landmarks || gd_mesh_summary(surface->mesh)->faces < LEAST_FACES ||
        atomic_load(&slot->base.is_closed))
        return NULL;
    atomic_store(&slot->base.owner, landmarks);
    pthread_mutex_lock(&landmarks->lru.lock);
    struct server_lru_item *item = server_lru_get(&slot->base.item);
    bool is_queued = !item && gd_now_ns() >= slot->not_before_ns &&
                     server_background_queue(landmarks, &slot->base);
    pthread_mutex_unlock(&landmarks->lru.lock);
    if (is_queued) server_thread_wake(landmarks->thread);
    return (struct server_landmark_set *)item;
}

struct server_background *server_landmarks_create(const struct server_background_parts *parts,
                                                  struct server_metrics *metrics, uint32_t count)
{
    struct server_landmarks *landmarks = calloc(1, sizeof *landmarks);
    if (!landmarks) return NULL;
    landmarks->background = (struct server_background){.lru = {.class = SERVER_BUDGET_LANDMARKS,
                                                               .turn = SERVER_RECLAIM_LANDMARKS,
                                                               .free = set_free,
                                                               .evicted = set_on_eviction},
                                                       .parts = *parts,
                                                       .make = set_make,
                                                       .ended = set_on_end};
    landmarks->metrics = metrics;
    landmarks->count = count;
    return server_background_start(&landmarks->background);
}

struct server_landmarks_statistics server_landmarks_statistics(struct server_background *landmarks)
{
    if (!landmarks) return (struct server_landmarks_statistics){0};
    SERVER_LOCK(&landmarks->lru.lock);
    return ((struct server_landmarks *)landmarks)->statistics;
}
