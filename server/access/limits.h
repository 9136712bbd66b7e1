/* Limits: how often, and how many at once. A quota counts how much of its limits a key has used.
 *
 * A rate of r a second is a bucket of r tokens that fills at that rate: GCRA, stored as the time at
 * which the bucket is full again, so that a request is one compare-and-swap. (ATM Forum, Traffic
 * Management 4.0, 4.4.2.) */
#ifndef SERVER_ACCESS_LIMITS_H
#define SERVER_ACCESS_LIMITS_H

#include <stdatomic.h>
#include <stdint.h>

#define SERVER_LIMITS_RATE_MOST       1000000u
#define SERVER_LIMITS_CONCURRENT_MOST 1000000u

struct server_limits { /* 0: no limit */
    uint32_t rate;     /* requests a second */
    uint32_t concurrent;
};

enum server_quota_outcome { SERVER_QUOTA_ENTERED, SERVER_QUOTA_RATE, SERVER_QUOTA_CONCURRENT };

/* Reference-counted: running requests keep it after its key is gone. */
struct server_quota {
    atomic_uint references;
    atomic_uint_least64_t entered;     /* running requests */
    atomic_uint_least64_t full_ns;     /* when the bucket is full again */
    atomic_uint_least64_t requests;    /* since the start, refused ones included */
    atomic_uint_least64_t refusals[3]; /* by enum server_quota_outcome */
    atomic_uint_least64_t forbidden;   /* by the role */
};

/* One reference; NULL without memory. */
struct server_quota *server_quota_create(void);
struct server_quota *server_quota_retain(struct server_quota *quota);
void server_quota_release(struct server_quota *quota); /* NULL is harmless */

/* Counts a request at `now_ns`. A request that entered must leave. A refused one gets `*wait_ns`,
 * how long to wait, or 0 where that is unknown. Thread-safe. */
enum server_quota_outcome server_quota_enter(struct server_quota *quota,
                                             const struct server_limits *limits, uint64_t now_ns,
                                             uint64_t *wait_ns);
void server_quota_leave(struct server_quota *quota);

#endif
