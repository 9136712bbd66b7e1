#include "server/work/lanes.h"

#include <stdlib.h>
#include <string.h>

#define TURNS 16 /* number of urgent jobs that precede a waiting patient job */

/* --- lists of jobs ---------------------------------------------------------------------------- */

bool server_job_is_late(const struct server_job *job, uint64_t now_ns)
{
    return job->deadline_ns <= now_ns ||
           atomic_load_explicit(&job->is_unwanted, memory_order_relaxed);
}

struct server_job *server_jobs_expire(struct server_job **list, uint64_t now_ns)
{
    struct server_job *expired = NULL;
    for (struct server_job **link = list; *link;) {
        struct server_job *job = *link;
        if (!server_job_is_late(job, now_ns)) {
            link = &job->next;
            continue;
        }
        *link = job->next;
        job->next = expired;
        expired = job;
    }
    return expired;
}

void server_jobs_refuse(struct server_job *list, enum server_refusal why)
{
    while (list) {
        struct server_job *next = list->next; /* `refuse` may free the job */
        list->refuse(list, why);
        list = next;
    }
}

/* --- lanes ------------------------------------------------------------------------------------ */

static void lane_init(struct server_lane *lane, const char *tenant)
{
    *lane = (struct server_lane){.tenant = tenant};
    for (int kind = 0; kind < SERVER_LANE_KINDS; kind++)
        lane->queues[kind].tail = &lane->queues[kind].head;
}

void server_lanes_init(struct server_lanes *lanes, uint32_t workers, uint32_t length)
{
    *lanes = (struct server_lanes){.workers = workers, .length = length};
    lane_init(&lanes->own, "");
}

static uint32_t lane_running(const struct server_lane *lane)
{
    return lane->running[SERVER_LANE_URGENT] + lane->running[SERVER_LANE_PATIENT];
}

static struct server_lane *lanes_find(const struct server_lanes *lanes, const char *tenant)
{
    struct server_lane *lane = lanes->active;
    while (lane && strcmp(lane->tenant, tenant) != 0) lane = lane->next;
    return lane;
}

static uint64_t lanes_least_used(const struct server_lanes *lanes)
{
    uint64_t least = lanes->active ? UINT64_MAX : 0;
    for (const struct server_lane *lane = lanes->active; lane; lane = lane->next)
        if (lane->used_ns < least) least = lane->used_ns;
    return least;
}

/* Returns the lane of a tenant. A tenant whose lane can't be allocated shares the lane "". */
struct server_lane *server_lanes_of(struct server_lanes *lanes, const char *tenant)
{
    if (!tenant) tenant = "";
    struct server_lane *lane = lanes_find(lanes, tenant);
    if (lane) return lane;
    lane = *tenant ? malloc(sizeof *lane + strlen(tenant) + 1) : NULL;
    if (lane)
        lane_init(lane, strcpy((char *)(lane + 1), tenant));
    else if ((lane = lanes_find(lanes, "")))
        return lane;
    else
        lane = &lanes->own;
    lane->used_ns = lanes_least_used(lanes);
    lane->next = lanes->active;
    lanes->active = lane;
    return lane;
}

static void lanes_drop_if_idle(struct server_lanes *lanes, struct server_lane *lane)
{
    struct server_lane **link = &lanes->active;
    if (lane_running(lane) || lane->queues[SERVER_LANE_URGENT].count ||
        lane->queues[SERVER_LANE_PATIENT].count)
        return;
    while (*link != lane) link = &(*link)->next;
    *link = lane->next;
    if (lane != &lanes->own) free(lane);
}

/* --- in and out ------------------------------------------------------------------------------- */

bool server_lanes_push(struct server_lanes *lanes, struct server_lane *lane, struct server_job *job,
                       bool is_first)
{
    struct server_lane_queue *queue = &lane->queues[job->is_patient];
    uint32_t queued = lanes->queued[job->is_patient];
    uint32_t places = lanes->length > queued ? lanes->length - queued : 0;
    if (!is_first && (lanes->is_shared ? queue->count : 0) >= places) {
        lanes_drop_if_idle(lanes, lane);
        return false;
    }
    struct server_job **link = is_first ? &queue->head : queue->tail;
    job->lane = lane;
    job->next = *link;
    *link = job;
    if (!job->next) queue->tail = &job->next;
    queue->count++;
    lanes->queued[job->is_patient]++;
    return true;
}

static bool lanes_may_take(const struct server_lanes *lanes, const struct server_lane *lane,
                           enum server_lane_kind kind, bool is_spare)
{
    if (!lane->queues[kind].count) return false;
    if (!is_spare || !lane_running(lane)) return true;
    return kind == SERVER_LANE_URGENT &&
           (!lane->running[kind] || lanes->running[SERVER_LANE_URGENT] < lanes->workers);
}

static struct server_lane *lanes_choose(const struct server_lanes *lanes,
                                        enum server_lane_kind kind, bool is_spare)
{
    struct server_lane *best = NULL;
    uint32_t fewest = 0;
    for (struct server_lane *lane = lanes->active; lane; lane = lane->next) {
        uint32_t running = lane_running(lane);
        if (!lanes_may_take(lanes, lane, kind, is_spare)) continue;
        if (best && (running > fewest || (running == fewest && lane->used_ns >= best->used_ns)))
            continue;
        best = lane;
        fewest = running;
    }
    return best;
}

struct server_job *server_lanes_take(struct server_lanes *lanes, bool is_spare)
{
    bool is_patients_turn = lanes->turns >= TURNS && lanes->queued[SERVER_LANE_PATIENT];
    enum server_lane_kind kind = is_patients_turn ? SERVER_LANE_PATIENT : SERVER_LANE_URGENT;
    struct server_lane *lane = lanes_choose(lanes, kind, is_spare);
    if (!lane) lane = lanes_choose(lanes, kind = kind == SERVER_LANE_URGENT, is_spare);
    if (!lane) return NULL;
    bool is_over_patient = kind == SERVER_LANE_URGENT && lanes->queued[SERVER_LANE_PATIENT];
    lanes->turns = is_over_patient ? lanes->turns + 1 : 0;
    struct server_lane_queue *queue = &lane->queues[kind];
    struct server_job *job = queue->head;
    queue->head = job->next;
    if (!queue->head) queue->tail = &queue->head;
    queue->count--;
    lanes->queued[kind]--;
    lane->running[kind]++;
    lanes->running[kind]++;
    return job;
}

void server_lanes_end(struct server_lanes *lanes, struct server_lane *lane, bool is_patient,
                      uint64_t ns)
{
    lane->running[is_patient]--;
    lanes->running[is_patient]--;
    lane->used_ns += ns;
    lanes_drop_if_idle(lanes, lane);
}

struct server_job *server_lanes_expire(struct server_lanes *lanes, uint64_t now_ns)
{
    struct server_job *all = NULL, **end = &all;
    for (struct server_lane *lane = lanes->active, *next; lane; lane = next) {
        next = lane->next;
        for (int kind = 0; kind < SERVER_LANE_KINDS; kind++) {
            struct server_lane_queue *queue = &lane->queues[kind];
            for (*end = server_jobs_expire(&queue->head, now_ns); *end; end = &(*end)->next) {
                queue->count--;
                lanes->queued[kind]--;
            }
            for (queue->tail = &queue->head; *queue->tail;) queue->tail = &(*queue->tail)->next;
        }
        lanes_drop_if_idle(lanes, lane);
    }
    return all;
}

uint32_t server_lanes_queued(const struct server_lanes *lanes)
{
    return lanes->queued[SERVER_LANE_URGENT] + lanes->queued[SERVER_LANE_PATIENT];
}

uint32_t server_lanes_running(const struct server_lanes *lanes)
{
    return lanes->running[SERVER_LANE_URGENT] + lanes->running[SERVER_LANE_PATIENT];
}
