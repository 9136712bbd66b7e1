/* Credentials: the keys of the daemon's users. They are read from a file that has one line for each
 * key. `geodesicd keygen` prints such a line:
 *
 *     # name  SHA-256 of the key  rights
 *     ci      sha256:9f86d0…      role=write expires=2027-01-31 rate=50 concurrent=8
 *     viewer  sha256:60303a…      role=read tenant=ci
 *     watch   sha256:cd42404d…    role=operator
 *
 * Each key is a tenant with its own names of surfaces, unless tenant= names another tenant. An
 * empty "tenant=" names the tenant of a daemon without keys.
 *
 * A key has 258 random bits and is shown once. The file holds only its SHA-256. A set of keys is
 * immutable and reference-counted. Reading the file again creates a new set. A key keeps its quota
 * if its name was in the old set. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/error.h"
#include "server/base/sha256.h"
#include "server/work/budget.h"

#define SERVER_CREDENTIAL_NAME 65 /* bytes, with the NUL */
/* people, and scanners for secrets, recognise a key by this prefix */
#define SERVER_CREDENTIAL_PREFIX "gdk_"
#define SERVER_CREDENTIALS_MOST  10000
#define SERVER_LIMITS_MOST       1000000u

struct server_limits { /* 0 means no limit */
    uint32_t rate;     /* requests a second */
    uint32_t concurrent;
};

enum server_quota_outcome { SERVER_QUOTA_ENTERED, SERVER_QUOTA_RATE, SERVER_QUOTA_CONCURRENT };

/* How much a key has used of its limits. Quotas are reference-counted: a running request keeps its
 * quota after the key is removed.
 *
 * A rate of r a second is a token bucket of r tokens that fills at that rate. The bucket is stored
 * as the time at which it will be full again (GCRA), so that counting a request is one
 * compare-and-swap. (ATM Forum, Traffic Management 4.0, 4.4.2.) */
struct server_quota {
    atomic_uint references;
    atomic_uint_least64_t entered;     /* running requests */
    atomic_uint_least64_t full_ns;     /* time at which the bucket is full again */
    atomic_uint_least64_t requests;    /* since the start, including refused requests */
    atomic_uint_least64_t refusals[3]; /* refused requests, by enum server_quota_outcome */
    atomic_uint_least64_t forbidden;   /* requests refused because of the role */
};

/* Creates a quota with one reference. Returns NULL if out of memory. */
struct server_quota *server_quota_create(void);
struct server_quota *server_quota_retain(struct server_quota *quota);
void server_quota_release(struct server_quota *quota); /* NULL is allowed */

/* Counts a request at `now_ns`. The caller ends an admitted request by server_quota_leave. If the
 * request is refused, sets `*wait_ns` to the time to wait, or to 0 if that is unknown.
 * Thread-safe. */
enum server_quota_outcome server_quota_enter(struct server_quota *quota,
                                             const struct server_limits *limits, uint64_t now_ns,
                                             uint64_t *wait_ns);
void server_quota_leave(struct server_quota *quota);

/* As server_quota_enter, for a request that takes no place among the concurrent requests: only the
 * rate limits it. Such a request does not leave. */
enum server_quota_outcome server_quota_pass(struct server_quota *quota,
                                            const struct server_limits *limits, uint64_t now_ns,
                                            uint64_t *wait_ns);

/* The role operator includes the role read, and may also see the metrics of all tenants. */
enum server_role { SERVER_ROLE_READ, SERVER_ROLE_WRITE, SERVER_ROLE_OPERATOR };

struct server_credential {
    char name[SERVER_CREDENTIAL_NAME];   /* [A-Za-z0-9_][A-Za-z0-9._-]* */
    char tenant[SERVER_CREDENTIAL_NAME]; /* see kind.h */
    char sha256[SERVER_SHA256_HEX];
    enum server_role role;
    unsigned given;  /* one bit for each setting of the line */
    int64_t expires; /* seconds since 1970; 0 means never */
    struct server_limits limits;
    struct server_quota *quota;
    struct server_share *share; /* of the tenant; set by access.c */
};

struct server_credentials {
    atomic_uint references;
    uint32_t count;
    struct server_credential *keys;
};

/* Reads the file. `before` is the set that the new set replaces, or NULL. Returns one reference. On
 * failure (unreadable, no key, malformed, or a repeated name or key) returns NULL with a sentence
 * in `error` that names the line. */
struct server_credentials *server_credentials_load(const char *path,
                                                   const struct server_credentials *before,
                                                   char error[SERVER_ERROR]);
struct server_credentials *server_credentials_retain(struct server_credentials *keys);
void server_credentials_release(struct server_credentials *keys); /* NULL is allowed */

/* Finds the set's key that has this text. Returns NULL if there is none. The time of the search
 * does not depend on the text. */
const struct server_credential *server_credentials_find(const struct server_credentials *keys,
                                                        const char *text, size_t size);

/* Parses a setting of a line, such as "role=write", in place. On failure returns false with a
 * sentence in `error`. */
bool server_credentials_set(struct server_credential *key, char *setting, char error[SERVER_ERROR]);

/* Returns whether the text has the form of a name. */
bool server_credentials_is_name(const char *text);

/* keygen.c: runs `geodesicd keygen`; `argv` begins with the name of the key. Prints two lines for
 * scripts to `out`: the key, and then the key's line for the file of --keys. Prints an explanation
 * to `error`. Returns false after printing a sentence to `error`. */
bool server_keygen(int argc, char *const argv[], FILE *out, FILE *error);
