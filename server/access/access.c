/* See access.h. */
#include "server/access/access.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "gd/control.h"

#define BEARER    "Bearer"
#define CHALLENGE "Bearer realm=\"geodesicd\""
/* RFC 6750, 2.1 */
#define TOKEN_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~+/="

struct server_access {
    char *path;
    pthread_mutex_t lock; /* of `keys`: the pointer, not what it points at */
    struct server_credentials *keys;
};

/* --- the set in force ------------------------------------------------------------------------- */

struct server_access *server_access_create(const char *path, char *error, size_t error_size)
{
    struct server_access *access = calloc(1, sizeof *access);
    if (!access) return NULL;
    pthread_mutex_init(&access->lock, NULL);
    access->path = strdup(path);
    if (access->path) access->keys = server_credentials_load(path, NULL, error, error_size);
    if (access->keys) return access;
    server_access_destroy(access);
    return NULL;
}

void server_access_destroy(struct server_access *access)
{
    if (!access) return;
    server_credentials_release(access->keys);
    pthread_mutex_destroy(&access->lock);
    free(access->path);
    free(access);
}

static struct server_credentials *retain_keys(struct server_access *access)
{
    pthread_mutex_lock(&access->lock);
    struct server_credentials *keys = server_credentials_retain(access->keys);
    pthread_mutex_unlock(&access->lock);
    return keys;
}

bool server_access_reload(struct server_access *access, char *error, size_t error_size)
{
    struct server_credentials *before = retain_keys(access),
                              *keys =
                                  server_credentials_load(access->path, before, error, error_size);
    server_credentials_release(before);
    if (!keys) return false;
    pthread_mutex_lock(&access->lock);
    before = access->keys;
    access->keys = keys;
    pthread_mutex_unlock(&access->lock);
    server_credentials_release(before);
    return true;
}

/* --- admission -------------------------------------------------------------------------------- */

static bool refuse(struct proto_problem *problem, const char *challenge, const char *sentence)
{
    proto_problem_set(problem, PROTO_PROBLEM_UNAUTHORIZED, "%s", sentence);
    problem->challenge = challenge;
    return false;
}

/* The token of "Bearer token"; NULL: it has another form. */
static const char *read_token(const char *authorization)
{
    size_t size = strlen(BEARER);
    if (strncasecmp(authorization, BEARER, size) != 0 || authorization[size] != ' ') return NULL;
    const char *token = authorization + size + strspn(authorization + size, " ");
    return *token && strspn(token, TOKEN_BYTES) == strlen(token) ? token : NULL;
}

static bool identify(const struct server_access_request *request, struct server_grant *grant,
                     struct proto_problem *problem)
{
    static const char wrong[] = CHALLENGE ", error=\"invalid_token\"";
    if (request->authorization_count != 1)
        return refuse(problem, CHALLENGE,
                      "send a key, once, as the header Authorization: Bearer KEY");
    const char *token = read_token(request->authorization);
    if (!token)
        return refuse(problem, CHALLENGE,
                      "the Authorization header is not of the form: Bearer KEY");
    grant->key = server_credentials_find(grant->keys, token, strlen(token));
    if (!grant->key)
        return refuse(problem, wrong, "this key is not known here; ask the operator for one");
    return !grant->key->expires || time(NULL) < grant->key->expires ||
           refuse(problem, wrong, "this key has expired; ask the operator for a new one");
}

static bool forbid(const struct server_credential *key, struct proto_problem *problem,
                   const char *sentence)
{
    atomic_fetch_add_explicit(&key->quota->forbidden, 1, memory_order_relaxed);
    proto_problem_set(problem, PROTO_PROBLEM_FORBIDDEN, "%s", sentence);
    problem->challenge = CHALLENGE ", error=\"insufficient_scope\"";
    return false;
}

static bool allow(const struct server_credential *key, enum proto_access needed,
                  struct proto_problem *problem)
{
    return needed != PROTO_ACCESS_WRITE || key->role == SERVER_ROLE_WRITE ||
           forbid(key, problem,
                  "this key may only read; ask the operator for one of the role write");
}

static bool enter(struct server_grant *grant, struct proto_problem *problem)
{
    const struct server_credential *key = grant->key;
    uint64_t wait_ns = 0;
    enum server_quota_outcome outcome =
        server_quota_enter(key->quota, &key->limits, gd_now_ns(), &wait_ns);
    grant->is_entered = outcome == SERVER_QUOTA_ENTERED;
    if (grant->is_entered) return true;
    if (outcome == SERVER_QUOTA_RATE) {
        proto_problem_set(
            problem, PROTO_PROBLEM_RATE_LIMITED,
            "this key may send %u requests a second; wait as long as Retry-After says",
            key->limits.rate);
        proto_problem_limit(problem, key->limits.rate);
    } else {
        proto_problem_set(
            problem, PROTO_PROBLEM_RATE_LIMITED,
            "this key may have %u requests under way at once; wait until one has been answered",
            key->limits.concurrent);
        proto_problem_limit(problem, key->limits.concurrent);
    }
    problem->retry_after = 1 + (unsigned)(wait_ns / 1000000000);
    return false;
}

bool server_access_admit(struct server_access *access, const struct server_access_request *request,
                         struct server_grant *grant, struct proto_problem *problem)
{
    if (!access || request->needed == PROTO_ACCESS_PUBLIC) return true;
    grant->keys = retain_keys(access);
    return identify(request, grant, problem) && allow(grant->key, request->needed, problem) &&
           enter(grant, problem);
}

/* --- grants ----------------------------------------------------------------------------------- */

const char *server_grant_name(const struct server_grant *grant)
{
    return grant->key ? grant->key->name : NULL;
}

const char *server_grant_tenant(const struct server_grant *grant)
{
    return grant->key ? grant->key->tenant : "";
}

bool server_grant_may_change(const struct server_grant *grant, const char *key,
                             struct proto_problem *problem)
{
    const struct server_credential *own = grant->key;
    return !own || own->role == SERVER_ROLE_WRITE || strcmp(own->name, key) == 0 ||
           forbid(own, problem,
                  "another key began this, and this one may change only what it began itself; "
                  "ask the operator for one of the role write");
}

bool server_grant_is_operator(const struct server_grant *grant)
{
    return !grant->key || grant->key->role == SERVER_ROLE_OPERATOR;
}

void server_grant_pass(struct server_grant *from, struct server_grant *to)
{
    *to = *from;
    from->is_entered = false;
    if (from->keys) server_credentials_retain(from->keys);
}

void server_grant_end(struct server_grant *grant)
{
    if (grant->is_entered) server_quota_leave(grant->key->quota);
    server_credentials_release(grant->keys);
    *grant = (struct server_grant){0};
}

/* --- metrics ---------------------------------------------------------------------------------- */

static void write_head(struct proto_writer *writer, const char *name, const char *kind,
                       const char *help)
{
    proto_append_format(writer, "# HELP geodesicd_%s %s\n# TYPE geodesicd_%s %s\n", name, help,
                        name, kind);
}

static void write_refusals(const struct server_credential *key, const char *reason, uint64_t count,
                           struct proto_writer *writer)
{
    proto_append_format(writer, "geodesicd_key_refusals_total{key=\"%s\",reason=\"%s\"} %llu\n",
                        key->name, reason, (unsigned long long)count);
}

static void write_all_requests(const struct server_credential *key, struct proto_writer *writer)
{
    proto_append_format(writer, "geodesicd_key_requests_total{key=\"%s\"} %llu\n", key->name,
                        (unsigned long long)atomic_load(&key->quota->requests));
}

static void write_requests(const struct server_credential *key, struct proto_writer *writer)
{
    proto_append_format(writer, "geodesicd_key_requests{key=\"%s\"} %u\n", key->name,
                        atomic_load(&key->quota->entered));
}

static void write_all_refusals(const struct server_credential *key, struct proto_writer *writer)
{
    write_refusals(key, "role", atomic_load(&key->quota->forbidden), writer);
    write_refusals(key, "rate", atomic_load(&key->quota->refusals[SERVER_QUOTA_RATE]), writer);
    write_refusals(key, "concurrent", atomic_load(&key->quota->refusals[SERVER_QUOTA_CONCURRENT]),
                   writer);
}

static void
write_each(const struct server_credentials *keys, const char *tenant, struct proto_writer *writer,
           void (*write)(const struct server_credential *key, struct proto_writer *writer))
{
    for (uint32_t i = 0; i < server_credentials_count(keys); i++) {
        const struct server_credential *key = server_credentials_at(keys, i);
        if (!tenant || strcmp(key->tenant, tenant) == 0) write(key, writer);
    }
}

void server_access_write(struct server_access *access, const char *tenant,
                         struct proto_writer *writer)
{
    if (!access) return;
    struct server_credentials *keys = retain_keys(access);
    write_head(writer, "key_requests_total", "counter",
               "Requests by key, those that its limits refused included.");
    write_each(keys, tenant, writer, write_all_requests);
    write_head(writer, "key_requests", "gauge", "Requests and jobs under way by key.");
    write_each(keys, tenant, writer, write_requests);
    write_head(writer, "key_refusals_total", "counter", "Requests refused by key and reason.");
    write_each(keys, tenant, writer, write_all_refusals);
    server_credentials_release(keys);
}
