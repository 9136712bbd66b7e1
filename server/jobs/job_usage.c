/* See job_usage.h. */
#include "server/jobs/job_usage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct server_job_usage *server_job_usage_of(struct server_job_usage **list, const char *tenant,
                                             const char *key)
{
    struct server_job_usage **link = list;
    int order;
    while (*link && (order = strcmp((*link)->tenant, tenant)) <= 0) {
        if (order == 0 && strcmp((*link)->key, key) == 0) return *link;
        link = &(*link)->next;
    }
    struct server_job_usage *usage = calloc(1, sizeof *usage);
    if (!usage) return NULL;
    snprintf(usage->tenant, sizeof usage->tenant, "%s", tenant);
    snprintf(usage->key, sizeof usage->key, "%s", key);
    usage->next = *link;
    *link = usage;
    return usage;
}

void server_job_usage_remove(struct server_job_usage **list, struct server_job_usage *usage)
{
    while (*list != usage) list = &(*list)->next;
    *list = usage->next;
    free(usage);
}

struct server_job_usage *server_job_usage_largest(struct server_job_usage *list,
                                                  enum server_job_unit unit,
                                                  const struct server_job_usage *newcomer,
                                                  uint64_t more)
{
    struct server_job_usage *largest = NULL;
    uint64_t largest_total = 0;
    for (struct server_job_usage *at = list, *first = list; at; first = at) {
        struct server_job_usage *best = NULL; /* of this tenant */
        uint64_t best_amount = 0, total = 0;
        for (; at && strcmp(at->tenant, first->tenant) == 0; at = at->next) {
            uint64_t amount = at->amounts[unit] + (at == newcomer ? more : 0);
            uint64_t fixed = unit == SERVER_JOB_UNIT_JOBS ? at->active : 0;
            total += amount;
            if (at != newcomer && at->amounts[unit] <= fixed) continue;
            if (best && amount <= best_amount) continue;
            best = at;
            best_amount = amount;
        }
        if (!best || (largest && total <= largest_total)) continue;
        largest = best;
        largest_total = total;
    }
    return largest;
}

uint64_t server_job_usage_active(const struct server_job_usage *list, const char *tenant)
{
    uint64_t active = 0;
    for (const struct server_job_usage *at = list; at; at = at->next)
        if (strcmp(at->tenant, tenant) == 0) active += at->active;
    return active;
}
