/* Holdings: how much of the table of jobs each key has, so that the room for it is shared: whoever
 * has the most makes way.
 *
 * Shares are of tenants first, then of the keys of a tenant: so a tenant gains nothing by many
 * keys. Not thread-safe: the lock of the jobs guards them. */
#ifndef SERVER_JOBS_HOLDINGS_H
#define SERVER_JOBS_HOLDINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/access/credentials.h"

enum server_measure { SERVER_MEASURE_JOBS, SERVER_MEASURE_BYTES, SERVER_MEASURES };

struct server_holding {
    struct server_holding *next;
    char tenant[SERVER_CREDENTIAL_NAME], key[SERVER_CREDENTIAL_NAME]; /* "" without keys */
    /* jobs, and bytes of their answers */
    uint64_t amounts[SERVER_MEASURES];
    uint64_t active; /* jobs that have not ended */
};

struct server_holdings {          /* all zero: none */
    struct server_holding *first; /* by tenant */
};

/* The key's; NULL without memory. */
struct server_holding *server_holdings_of(struct server_holdings *holdings, const char *tenant,
                                          const char *key);

/* Frees a holding of no jobs. */
void server_holdings_drop(struct server_holdings *holdings, struct server_holding *holding);

/* Whose ended jobs make way for so much more of `newcomer`: the key with the most of the tenant
 * with the most, of those that have something to give. The newcomer itself, if it has the most,
 * even if it has nothing to give. */
struct server_holding *server_holdings_largest(const struct server_holdings *holdings,
                                               enum server_measure measure,
                                               struct server_holding *newcomer, uint64_t more);

/* Jobs of a tenant that have not ended. */
uint64_t server_holdings_active(const struct server_holdings *holdings, const char *tenant);

#endif
