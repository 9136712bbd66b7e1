/* See lanes.h. */
#include "server/work/lanes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TURNS 16

/* --- lanes ------------------------------------------------------------------------------------ */

static void reset(struct server_lane *lane, const char *tenant)
{
    *lane = (struct server_lane){0};
    snprintf(lane->tenant, sizeof lane->tenant, "%s", tenant);
    for (int kind = 0; kind < SERVER_LANE_KINDS; kind++)
        lane->queues[kind].tail = &lane->queues[kind].head;
}

void server_lanes_init(struct server_lanes *lanes, uint32_t workers, uint32_t length)
{
    *lanes = (struct server_lanes){.workers = workers, .length = length};
    reset(&lanes->own, "");
}

static uint32_t running_in(const struct server_lane *lane)
{
    return lane->running[SERVER_LANE_URGENT] + lane->running[SERVER_LANE_PATIENT];
}

static bool is_idle(const struct server_lane *lane)
{
    return !running_in(lane) && !lane->queues[SERVER_LANE_URGENT].count &&
           !lane->queues[SERVER_LANE_PATIENT].count;
}

static struct server_lane *find(const struct server_lanes *lanes, const char *tenant)
{
    struct server_lane *lane = lanes->active;
    while (lane && strcmp(lane->tenant, tenant) != 0) lane = lane->next;
    return lane;
}

static uint64_t least_used(const struct server_lanes *lanes)
{
    uint64_t least = lanes->active ? UINT64_MAX : 0;
    for (const struct server_lane *lane = lanes->active; lane; lane = lane->next)
        if (lane->used_ns < least) least = lane->used_ns;
    return least;
}

/* Without memory for a lane of its own a tenant shares the one of all. */
struct server_lane *server_lanes_of(struct server_lanes *lanes, const char *tenant)
{
    struct server_lane *lane = find(lanes, tenant ? tenant : "");
    if (lane) return lane;
    lane = tenant && *tenant ? malloc(sizeof *lane) : NULL;
    if (lane)
        reset(lane, tenant);
    else if ((lane = find(lanes, "")))
        return lane;
    else
        lane = &lanes->own;
    lane->used_ns = least_used(lanes);
    lane->next = lanes->active;
    lanes->active = lane;
    return lane;
}

static void drop_if_idle(struct server_lanes *lanes, struct server_lane *lane)
{
    struct server_lane **link = &lanes->active;
    if (!is_idle(lane)) return;
    while (*link != lane) link = &(*link)->next;
    *link = lane->next;
    if (lane != &lanes->own) free(lane);
}

/* --- in --------------------------------------------------------------------------------------- */

static enum server_lane_kind kind_of(const struct server_job *job)
{
    return job->is_patient ? SERVER_LANE_PATIENT : SERVER_LANE_URGENT;
}

static bool has_place(const struct server_lanes *lanes, const struct server_lane *lane,
                      enum server_lane_kind kind)
{
    uint32_t free_places =
        lanes->length > lanes->queued[kind] ? lanes->length - lanes->queued[kind] : 0;
    return lanes->is_shared ? lane->queues[kind].count < free_places : free_places > 0;
}

static void count_in(struct server_lanes *lanes, struct server_lane *lane, struct server_job *job)
{
    job->lane = lane;
    lane->queues[kind_of(job)].count++;
    lanes->queued[kind_of(job)]++;
}

bool server_lanes_push(struct server_lanes *lanes, struct server_lane *lane, struct server_job *job)
{
    struct server_lane_queue *queue = &lane->queues[kind_of(job)];
    if (!has_place(lanes, lane, kind_of(job))) {
        drop_if_idle(lanes, lane);
        return false;
    }
    job->next = NULL;
    *queue->tail = job;
    queue->tail = &job->next;
    count_in(lanes, lane, job);
    return true;
}

void server_lanes_push_front(struct server_lanes *lanes, struct server_lane *lane,
                             struct server_job *job)
{
    struct server_lane_queue *queue = &lane->queues[kind_of(job)];
    job->next = queue->head;
    queue->head = job;
    if (!job->next) queue->tail = &job->next;
    count_in(lanes, lane, job);
}

/* --- out -------------------------------------------------------------------------------------- */

static bool may_take(const struct server_lanes *lanes, const struct server_lane *lane,
                     enum server_lane_kind kind, bool is_spare)
{
    if (!lane->queues[kind].count) return false;
    if (!is_spare || !running_in(lane)) return true;
    return kind == SERVER_LANE_URGENT &&
           (!lane->running[kind] || lanes->running[SERVER_LANE_URGENT] < lanes->workers);
}

static bool is_before(const struct server_lane *a, const struct server_lane *b)
{
    uint32_t a_runs = running_in(a), b_runs = running_in(b);
    return a_runs != b_runs ? a_runs < b_runs : a->used_ns < b->used_ns;
}

static struct server_lane *choose(const struct server_lanes *lanes, enum server_lane_kind kind,
                                  bool is_spare)
{
    struct server_lane *best = NULL;
    for (struct server_lane *lane = lanes->active; lane; lane = lane->next)
        if (may_take(lanes, lane, kind, is_spare) && (!best || is_before(lane, best))) best = lane;
    return best;
}

static struct server_job *take_from(struct server_lanes *lanes, struct server_lane *lane,
                                    enum server_lane_kind kind)
{
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

struct server_job *server_lanes_take(struct server_lanes *lanes, bool is_spare)
{
    bool is_its_turn = lanes->turns >= TURNS && lanes->queued[SERVER_LANE_PATIENT];
    enum server_lane_kind kind = is_its_turn ? SERVER_LANE_PATIENT : SERVER_LANE_URGENT;
    struct server_lane *lane = choose(lanes, kind, is_spare);
    if (!lane) lane = choose(lanes, kind = kind == SERVER_LANE_URGENT, is_spare);
    if (!lane) return NULL;
    lanes->turns =
        kind == SERVER_LANE_URGENT && lanes->queued[SERVER_LANE_PATIENT] ? lanes->turns + 1 : 0;
    return take_from(lanes, lane, kind);
}

void server_lanes_end(struct server_lanes *lanes, struct server_lane *lane, bool is_patient,
                      uint64_t ns)
{
    lane->running[is_patient]--;
    lanes->running[is_patient]--;
    lane->used_ns += ns;
    drop_if_idle(lanes, lane);
}

/* Puts the late jobs of a queue before the list. */
static struct server_job *expire_queue(struct server_lanes *lanes, struct server_lane *lane,
                                       enum server_lane_kind kind, uint64_t now_ns,
                                       struct server_job *list)
{
    struct server_lane_queue *queue = &lane->queues[kind];
    uint32_t before = queue->count;
    struct server_job *expired = server_jobs_expire(&queue->head, now_ns), **end = &expired;
    for (; *end; end = &(*end)->next) queue->count--;
    *end = list;
    for (queue->tail = &queue->head; *queue->tail; queue->tail = &(*queue->tail)->next) continue;
    lanes->queued[kind] -= before - queue->count;
    return expired;
}

struct server_job *server_lanes_expire(struct server_lanes *lanes, uint64_t now_ns)
{
    struct server_job *expired = NULL;
    for (struct server_lane *lane = lanes->active, *next; lane; lane = next) {
        next = lane->next;
        for (int kind = 0; kind < SERVER_LANE_KINDS; kind++)
            if (lane->queues[kind].count)
                expired = expire_queue(lanes, lane, kind, now_ns, expired);
        drop_if_idle(lanes, lane);
    }
    return expired;
}

uint32_t server_lanes_queued(const struct server_lanes *lanes)
{
    return lanes->queued[SERVER_LANE_URGENT] + lanes->queued[SERVER_LANE_PATIENT];
}

uint32_t server_lanes_running(const struct server_lanes *lanes)
{
    return lanes->running[SERVER_LANE_URGENT] + lanes->running[SERVER_LANE_PATIENT];
}
