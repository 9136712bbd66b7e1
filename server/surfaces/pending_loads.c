/* See pending_loads.h. */
#include "server/surfaces/pending_loads.h"

#include <pthread.h>
#include <stdlib.h>

struct server_pending_load {
    struct server_pending_loads *loads;
    struct server_pending_load *next;
    struct server_record *record;
    struct server_job *parked;
};

struct server_pending_loads {
    struct server_workers *workers;
    pthread_mutex_t lock;
    struct server_pending_load *first; /* as many as there are workers, and one more, at most */
};

struct server_pending_loads *server_pending_loads_create(struct server_workers *workers)
{
    struct server_pending_loads *loads = calloc(1, sizeof *loads);
    if (!loads) return NULL;
    loads->workers = workers;
    pthread_mutex_init(&loads->lock, NULL);
    return loads;
}

void server_pending_loads_destroy(struct server_pending_loads *loads)
{
    if (!loads) return;
    pthread_mutex_destroy(&loads->lock);
    free(loads);
}

/* --- under the lock --------------------------------------------------------------------------- */

static struct server_pending_load *find(struct server_pending_loads *loads,
                                        const struct server_record *record)
{
    struct server_pending_load *load = loads->first;
    while (load && load->record != record) load = load->next;
    return load;
}

static void park(struct server_pending_load *load, struct server_job *job)
{
    if (!job) return;
    job->next = load->parked;
    load->parked = job;
}

static struct server_pending_load *start(struct server_pending_loads *loads,
                                         struct server_record *record)
{
    struct server_pending_load *load = malloc(sizeof *load);
    if (!load) return NULL;
    *load = (struct server_pending_load){
        .loads = loads, .next = loads->first, .record = server_record_retain(record)};
    loads->first = load;
    return load;
}

/* --- in and out ------------------------------------------------------------------------------- */

enum server_pending_loads_turn server_pending_loads_enter(struct server_pending_loads *loads,
                                                          struct server_record *record,
                                                          struct server_job *job,
                                                          struct server_pending_load **load)
{
    pthread_mutex_lock(&loads->lock);
    struct server_pending_load *other = find(loads, record),
                               *own = other ? NULL : start(loads, record);
    if (other) park(other, job);
    pthread_mutex_unlock(&loads->lock);
    if (own) *load = own;
    return other ? SERVER_PENDING_LOADS_WAIT
           : own ? SERVER_PENDING_LOADS_LOAD
                 : SERVER_PENDING_LOADS_NO_MEMORY;
}

bool server_pending_loads_join(struct server_pending_loads *loads,
                               const struct server_record *record, struct server_job *job)
{
    pthread_mutex_lock(&loads->lock);
    struct server_pending_load *load = find(loads, record);
    if (load) park(load, job);
    pthread_mutex_unlock(&loads->lock);
    return load != NULL;
}

/* Takes the load out of the list and frees it; the jobs that were parked on it. */
static struct server_job *end(struct server_pending_load *load)
{
    struct server_pending_loads *loads = load->loads;
    pthread_mutex_lock(&loads->lock);
    struct server_pending_load **link = &loads->first;
    while (*link != load) link = &(*link)->next;
    *link = load->next;
    pthread_mutex_unlock(&loads->lock);
    struct server_job *parked = load->parked;
    server_record_release(load->record);
    free(load);
    return parked;
}

void server_pending_loads_end(struct server_pending_load *load)
{
    struct server_workers *workers = load->loads->workers;
    for (struct server_job *job = end(load), *next; job; job = next) {
        next = job->next;
        server_workers_resume(workers, job);
    }
}

void server_pending_loads_fail(struct server_pending_load *load, enum server_refusal why)
{
    server_jobs_refuse(end(load), why);
}

void server_pending_loads_expire(struct server_pending_loads *loads, uint64_t now_ns)
{
    struct server_job *expired = NULL, **last = &expired;
    pthread_mutex_lock(&loads->lock);
    for (struct server_pending_load *load = loads->first; load; load = load->next) {
        *last = server_jobs_expire(&load->parked, now_ns);
        while (*last) last = &(*last)->next;
    }
    pthread_mutex_unlock(&loads->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
