/* See credentials.h: quotas. */
#include "server/access/credentials.h"

#include <stdbool.h>
#include <stdlib.h>

#define SECOND_NS UINT64_C(1000000000)

struct server_quota *server_quota_create(void)
{
    struct server_quota *quota = calloc(1, sizeof *quota);
    if (quota) atomic_init(&quota->references, 1);
    return quota;
}

struct server_quota *server_quota_retain(struct server_quota *quota)
{
    atomic_fetch_add_explicit(&quota->references, 1, memory_order_relaxed);
    return quota;
}

void server_quota_release(struct server_quota *quota)
{
    if (quota && atomic_fetch_sub(&quota->references, 1) == 1) free(quota);
}

static bool place_take(struct server_quota *quota, uint32_t most)
{
    uint_least64_t entered = atomic_load(&quota->entered);
    do {
        if (most && entered >= most) return false;
    } while (!atomic_compare_exchange_weak(&quota->entered, &entered, entered + 1));
    return true;
}

/* The bucket has the token again an interval later. */
static bool token_take(struct server_quota *quota, uint32_t rate, uint64_t now_ns,
                       uint64_t *wait_ns)
{
    const uint64_t interval = SECOND_NS / rate, depth = interval * rate;
    uint64_t full = atomic_load(&quota->full_ns), next;
    do {
        next = (full > now_ns ? full : now_ns) + interval;
        if (next - now_ns > depth) {
            *wait_ns = next - now_ns - depth;
            return false;
        }
    } while (!atomic_compare_exchange_weak(&quota->full_ns, &full, next));
    return true;
}

enum server_quota_outcome server_quota_enter(struct server_quota *quota,
                                             const struct server_limits *limits, uint64_t now_ns,
                                             uint64_t *wait_ns)
{
    enum server_quota_outcome outcome = SERVER_QUOTA_ENTERED;
    *wait_ns = 0;
    atomic_fetch_add_explicit(&quota->requests, 1, memory_order_relaxed);
    if (!place_take(quota, limits->concurrent)) { /* first, so that it uses no token */
        outcome = SERVER_QUOTA_CONCURRENT;
    } else if (limits->rate && !token_take(quota, limits->rate, now_ns, wait_ns)) {
        outcome = SERVER_QUOTA_RATE;
        server_quota_leave(quota);
    }
    if (outcome != SERVER_QUOTA_ENTERED)
        atomic_fetch_add_explicit(&quota->refusals[outcome], 1, memory_order_relaxed);
    return outcome;
}

void server_quota_leave(struct server_quota *quota)
{
    atomic_fetch_sub(&quota->entered, 1);
}
