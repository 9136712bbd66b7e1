/* Job usage: how many jobs of the table, and how many bytes of answers, each key has. When the
 * table is full the largest user makes room.
 *
 * Tenants are compared first, then the keys of a tenant: many keys gain a tenant nothing. Not
 * thread-safe: the lock of the job table guards the list. */
#ifndef SERVER_JOBS_JOB_USAGE_H
#define SERVER_JOBS_JOB_USAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/access/credentials.h"

enum server_job_unit { SERVER_JOB_UNIT_JOBS, SERVER_JOB_UNIT_BYTES, SERVER_JOB_UNITS };

struct server_job_usage {
    struct server_job_usage *next;                                    /* sorted by tenant */
    char tenant[SERVER_CREDENTIAL_NAME], key[SERVER_CREDENTIAL_NAME]; /* "" without keys */
    uint64_t amounts[SERVER_JOB_UNITS];
    uint64_t active; /* jobs that have not ended */
};

/* The usage of a key, added to the list if it is new; NULL without memory. */
struct server_job_usage *server_job_usage_of(struct server_job_usage **list, const char *tenant,
                                             const char *key);

/* Removes and frees a usage without jobs. */
void server_job_usage_remove(struct server_job_usage **list, struct server_job_usage *usage);

/* The usage whose ended jobs make room for `more` of `newcomer`: of the tenant with the most, the
 * key with the most, among those with something to drop. The newcomer, if it has the most, even
 * with nothing to drop. */
struct server_job_usage *server_job_usage_largest(struct server_job_usage *list,
                                                  enum server_job_unit unit,
                                                  const struct server_job_usage *newcomer,
                                                  uint64_t more);

/* Jobs of a tenant that have not ended. */
uint64_t server_job_usage_active(const struct server_job_usage *list, const char *tenant);

#endif
