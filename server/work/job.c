/* See job.h. */
#include "server/work/job.h"

#include <stddef.h>

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
        struct server_job *next = list->next; /* refusing may free the job */
        list->refuse(list, why);
        list = next;
    }
}
