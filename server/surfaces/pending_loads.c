/* See pending_loads.h. */
#include "server/surfaces/pending_loads.h"

#include <pthread.h>
#include <stdlib.h>
#include <sys/queue.h>

struct server_pending_load {
    LIST_ENTRY(server_pending_load) next;
    struct server_pending_loads *loads;
    struct server_record *record;
    struct server_job *parked;
};

struct server_pending_loads {
    struct server_workers *workers;
    pthread_mutex_t lock;
    LIST_HEAD(, server_pending_load) all; /* as many as there are workers, and one more, at most */
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

/* Under the lock: parks a job (NULL is harmless) if the record is being loaded; false: it is not.
 */
static bool load_join(struct server_pending_loads *loads, const struct server_record *record,
                      struct server_job *job)
{
    struct server_pending_load *load;
    LIST_FOREACH(load, &loads->all, next)
    if (load->record == record) break;
    if (load && job) {
        job->next = load->parked;
        load->parked = job;
    }
    return load != NULL;
}

enum server_pending_loads_turn server_pending_loads_enter(struct server_pending_loads *loads,
                                                          struct server_record *record,
                                                          struct server_job *job,
                                                          struct server_pending_load **load)
{
    struct server_pending_load *own = NULL;
    pthread_mutex_lock(&loads->lock);
    bool is_parked = load_join(loads, record, job);
    if (!is_parked) own = malloc(sizeof *own);
    if (own) {
        *own = (struct server_pending_load){.loads = loads, .record = server_record_retain(record)};
        LIST_INSERT_HEAD(&loads->all, own, next);
        *load = own;
    }
    pthread_mutex_unlock(&loads->lock);
    return is_parked ? SERVER_PENDING_LOADS_WAIT
           : own     ? SERVER_PENDING_LOADS_LOAD
                     : SERVER_PENDING_LOADS_NO_MEMORY;
}

bool server_pending_loads_join(struct server_pending_loads *loads,
                               const struct server_record *record, struct server_job *job)
{
    pthread_mutex_lock(&loads->lock);
    bool is_parked = load_join(loads, record, job);
    pthread_mutex_unlock(&loads->lock);
    return is_parked;
}

/* Removes the load and frees it; returns the jobs that were parked on it. */
static struct server_job *load_remove(struct server_pending_load *load)
{
    pthread_mutex_lock(&load->loads->lock);
    LIST_REMOVE(load, next);
    pthread_mutex_unlock(&load->loads->lock);
    struct server_job *parked = load->parked;
    server_record_release(load->record);
    free(load);
    return parked;
}

void server_pending_loads_end(struct server_pending_load *load)
{
    struct server_workers *workers = load->loads->workers;
    for (struct server_job *job = load_remove(load), *next; job; job = next) {
        next = job->next;
        server_workers_resume(workers, job);
    }
}

void server_pending_loads_fail(struct server_pending_load *load, enum server_refusal why)
{
    server_jobs_refuse(load_remove(load), why);
}

void server_pending_loads_expire(struct server_pending_loads *loads, uint64_t now_ns)
{
    struct server_job *expired = NULL, **end = &expired;
    struct server_pending_load *load;
    pthread_mutex_lock(&loads->lock);
    LIST_FOREACH(load, &loads->all, next)
    {
        *end = server_jobs_expire(&load->parked, now_ns);
        while (*end) end = &(*end)->next;
    }
    pthread_mutex_unlock(&loads->lock);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
}
