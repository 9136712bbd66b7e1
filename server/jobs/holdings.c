/* See holdings.h. */
#include "server/jobs/holdings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct server_holding *server_holdings_of(struct server_holdings *holdings, const char *tenant,
                                          const char *key)
{
    struct server_holding **link = &holdings->first;
    int order;
    while (*link && (order = strcmp((*link)->tenant, tenant)) <= 0) {
        if (order == 0 && strcmp((*link)->key, key) == 0) return *link;
        link = &(*link)->next;
    }
    struct server_holding *holding = calloc(1, sizeof *holding);
    if (!holding) return NULL;
    snprintf(holding->tenant, sizeof holding->tenant, "%s", tenant);
    snprintf(holding->key, sizeof holding->key, "%s", key);
    holding->next = *link;
    *link = holding;
    return holding;
}

void server_holdings_drop(struct server_holdings *holdings, struct server_holding *holding)
{
    struct server_holding **link = &holdings->first;
    while (*link != holding) link = &(*link)->next;
    *link = holding->next;
    free(holding);
}

static bool has_something(const struct server_holding *holding, enum server_measure measure)
{
    return measure == SERVER_MEASURE_BYTES ? holding->amounts[measure] > 0
                                           : holding->amounts[measure] > holding->active;
}

struct candidate { /* the key with the most of a tenant that has something to give */
    struct server_holding *holding;
    uint64_t amount, tenants; /* the key's, the tenant's */
};

/* The candidate of the tenant whose holdings begin there; `*end` is the next tenant's first. */
static struct candidate weigh_tenant(struct server_holding *from, enum server_measure measure,
                                     struct server_holding *newcomer, uint64_t more,
                                     struct server_holding **end)
{
    struct candidate best = {0};
    struct server_holding *at = from;
    for (; at && strcmp(at->tenant, from->tenant) == 0; at = at->next) {
        uint64_t amount = at->amounts[measure] + (at == newcomer ? more : 0);
        best.tenants += amount;
        if (at != newcomer && !has_something(at, measure)) continue;
        if (best.holding && amount <= best.amount) continue;
        best.holding = at;
        best.amount = amount;
    }
    *end = at;
    return best;
}

struct server_holding *server_holdings_largest(const struct server_holdings *holdings,
                                               enum server_measure measure,
                                               struct server_holding *newcomer, uint64_t more)
{
    struct candidate best = {0};
    for (struct server_holding *at = holdings->first; at;) {
        struct candidate candidate = weigh_tenant(at, measure, newcomer, more, &at);
        if (candidate.holding && (!best.holding || candidate.tenants > best.tenants))
            best = candidate;
    }
    return best.holding;
}

uint64_t server_holdings_active(const struct server_holdings *holdings, const char *tenant)
{
    uint64_t active = 0;
    for (const struct server_holding *at = holdings->first; at; at = at->next)
        if (strcmp(at->tenant, tenant) == 0) active += at->active;
    return active;
}
