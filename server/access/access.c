#include "server/access/access.h"

#include <arpa/inet.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/thread.h"

#define BEARER    "Bearer"
#define CHALLENGE "Bearer realm=\"geodesicd\""
/* RFC 6750, 2.1 */
#define TOKEN_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~+/="

/* The share of a tenant. It is kept after the tenant's last key is removed, because answers may
 * still use it. */
struct tenant {
    struct tenant *next;
    struct server_share share;
    char name[SERVER_CREDENTIAL_NAME];
};

struct server_access {
    char *path;
    struct server_budget *budget;
    struct tenant *tenants; /* used by the thread that reads the file */
    pthread_mutex_t lock;   /* protects the pointer `keys` */
    struct server_credentials *keys;
};

/* --- the set in force ------------------------------------------------------------------------- */

static struct server_share *share_of(struct server_access *access, const char *name)
{
    struct tenant *tenant = access->tenants;
    while (tenant && strcmp(tenant->name, name) != 0) tenant = tenant->next;
    if (tenant) return &tenant->share;
    tenant = malloc(sizeof *tenant);
    if (!tenant) return NULL;
    server_share_init(&tenant->share, access->budget, true);
    strcpy(tenant->name, name);
    tenant->next = access->tenants;
    access->tenants = tenant;
    return &tenant->share;
}

static struct server_credentials *keys_load(struct server_access *access,
                                            const struct server_credentials *before,
                                            char error[SERVER_ERROR])
{
    struct server_credentials *keys = server_credentials_load(access->path, before, error);
    for (uint32_t i = 0; keys && i < keys->count; i++) {
        keys->keys[i].share = share_of(access, keys->keys[i].tenant);
        if (keys->keys[i].share) continue;
        server_credentials_release(keys);
        (void)server_refuse(error, "the system is out of memory");
        return NULL;
    }
    return keys;
}

struct server_access *server_access_create(const char *path, struct server_budget *budget,
                                           char error[SERVER_ERROR])
{
    struct server_access *access = calloc(1, sizeof *access);
    if (!access) return NULL;
    pthread_mutex_init(&access->lock, NULL);
    access->budget = budget;
    access->path = strdup(path);
    if (access->path) access->keys = keys_load(access, NULL, error);
    if (access->keys) return access;
    server_access_destroy(access);
    return NULL;
}

void server_access_destroy(struct server_access *access)
{
    if (!access) return;
    server_credentials_release(access->keys);
    for (struct tenant *tenant = access->tenants, *next; tenant; tenant = next) {
        next = tenant->next;
        free(tenant);
    }
    pthread_mutex_destroy(&access->lock);
    free(access->path);
    free(access);
}

static struct server_credentials *keys_retain(struct server_access *access)
{
    SERVER_LOCK(&access->lock);
    return server_credentials_retain(access->keys);
}

bool server_access_reload(struct server_access *access, char error[SERVER_ERROR])
{
    struct server_credentials *before = keys_retain(access);
    struct server_credentials *keys = keys_load(access, before, error);
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

static bool request_refuse(struct proto_problem *problem, const char *challenge,
                           const char *sentence)
{
    proto_problem_set(problem, PROTO_PROBLEM_UNAUTHORIZED, "%s", sentence);
    problem->challenge = challenge;
    return false;
}

static bool key_identify(const struct server_access_request *request, struct server_grant *grant,
                         struct proto_problem *problem)
{
    static const char wrong[] = CHALLENGE ", error=\"invalid_token\"";
    const size_t scheme = strlen(BEARER);
    if (request->authorization_count != 1)
        return request_refuse(problem, CHALLENGE,
                              "send one key as the header Authorization: Bearer KEY");
    const char *token = request->authorization + scheme;
    bool is_bearer = strncasecmp(request->authorization, BEARER, scheme) == 0 && *token == ' ';
    if (is_bearer) token += strspn(token, " ");
    if (!is_bearer || !*token || token[strspn(token, TOKEN_BYTES)])
        return request_refuse(problem, CHALLENGE,
                              "the Authorization header must have the form: Bearer KEY");
    grant->key = server_credentials_find(grant->keys, token, strlen(token));
    if (!grant->key)
        return request_refuse(problem, wrong,
                              "this key is not known here; ask the operator for one");
    return !grant->key->expires || time(NULL) < grant->key->expires ||
           request_refuse(problem, wrong, "this key has expired; ask the operator for a new one");
}

static bool key_forbid(const struct server_credential *key, struct proto_problem *problem,
                       const char *sentence)
{
    atomic_fetch_add_explicit(&key->quota->forbidden, 1, memory_order_relaxed);
    proto_problem_set(problem, PROTO_PROBLEM_FORBIDDEN, "%s", sentence);
    problem->challenge = CHALLENGE ", error=\"insufficient_scope\"";
    return false;
}

static bool quota_enter(struct server_grant *grant, bool is_follow_up,
                        struct proto_problem *problem)
{
    const struct server_credential *key = grant->key;
    uint64_t wait_ns = 0, now_ns = gd_now_ns();
    enum server_quota_outcome outcome =
        is_follow_up ? server_quota_pass(key->quota, &key->limits, now_ns, &wait_ns)
                     : server_quota_enter(key->quota, &key->limits, now_ns, &wait_ns);
    grant->is_entered = outcome == SERVER_QUOTA_ENTERED && !is_follow_up;
    if (outcome == SERVER_QUOTA_ENTERED) return true;
    bool is_rate = outcome == SERVER_QUOTA_RATE;
    unsigned limit = is_rate ? key->limits.rate : key->limits.concurrent;
    proto_problem_set(
        problem, PROTO_PROBLEM_RATE_LIMITED,
        is_rate ? "this key may send %u requests a second; wait as long as Retry-After says"
                : "this key may have %u requests at a time; wait until one is answered",
        limit);
    proto_problem_limit(problem, limit);
    problem->retry_after = 1 + (unsigned)(wait_ns / 1000000000);
    return false;
}

bool server_access_admit(struct server_access *access, const struct server_access_request *request,
                         struct server_grant *grant, struct proto_problem *problem)
{
    if (!access || request->needed == PROTO_ACCESS_PUBLIC) return true;
    grant->keys = keys_retain(access);
    if (!key_identify(request, grant, problem)) return false;
    if (request->needed == PROTO_ACCESS_WRITE && grant->key->role != SERVER_ROLE_WRITE)
        return key_forbid(grant->key, problem,
                          "this key may only read; ask the operator for a key with the role write");
    return quota_enter(grant, request->is_follow_up, problem);
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
           key_forbid(own, problem,
                      "this was started with another key, and this key may change only its own; "
                      "ask the operator for a key with the role write");
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

void server_access_write(struct server_access *access, const char *tenant,
                         struct proto_writer *writer)
{
    static const struct {
        /* `kind` is NULL if the entry is another value of the preceding metric */
        const char *name, *kind, *help, *reason;
        size_t offset;
    } counters[] = {
        {"key_requests_total", "counter",
         "Requests by key, those that its limits refused included.", "",
         offsetof(struct server_quota, requests)},
        {"key_requests", "gauge", "Requests and jobs under way by key.", "",
         offsetof(struct server_quota, entered)},
        {"key_refusals_total", "counter", "Requests refused by key and reason.", ",reason=\"role\"",
         offsetof(struct server_quota, forbidden)},
        {"key_refusals_total", NULL, NULL, ",reason=\"rate\"",
         offsetof(struct server_quota, refusals[SERVER_QUOTA_RATE])},
        {"key_refusals_total", NULL, NULL, ",reason=\"concurrent\"",
         offsetof(struct server_quota, refusals[SERVER_QUOTA_CONCURRENT])},
    };
    if (!access) return;
    struct server_credentials *keys = keys_retain(access);
    for (size_t i = 0; i < sizeof counters / sizeof *counters; i++) {
        const char *name = counters[i].name;
        if (counters[i].kind)
            proto_append_format(writer, "# HELP geodesicd_%s %s\n# TYPE geodesicd_%s %s\n", name,
                                counters[i].help, name, counters[i].kind);
        for (uint32_t k = 0; k < keys->count; k++) {
            const struct server_credential *key = &keys->keys[k];
            if (tenant && strcmp(key->tenant, tenant) != 0) continue;
            atomic_uint_least64_t *counter =
                (atomic_uint_least64_t *)((char *)key->quota + counters[i].offset);
            proto_append_format(writer, "geodesicd_%s{key=\"%s\"%s} %llu\n", name, key->name,
                                counters[i].reason, (unsigned long long)atomic_load(counter));
        }
    }
    server_credentials_release(keys);
}

/* --- the guard -------------------------------------------------------------------------------- */

static bool host_is_loopback(const char *host)
{
    struct in_addr v4;
    struct in6_addr v6;
    if (strcasecmp(host, "localhost") == 0 || strcmp(host, "127.0.0.1") == 0) return true;
    if (inet_pton(AF_INET, host, &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
    return inet_pton(AF_INET6, host, &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

static bool list_has(const struct server_config_list *list, const char *text)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (strcasecmp(text, list->name[i]) == 0) return true;
    return false;
}

static bool host_is_allowed(const struct server_config *config, const char *text)
{
    char host[SERVER_ADDRESS_HOST];
    const char *port;
    if (!server_address_split(text, host, &port)) return false;
    if (host_is_loopback(host) || (*config->keys && !config->allowed_hosts.count)) return true;
    return list_has(&config->allowed_hosts, host);
}

bool server_guard_lists(const struct server_config *config, const char *origin)
{
    return origin && list_has(&config->cors_origins, origin);
}

bool server_guard_admit(const struct server_config *config,
                        const struct server_guard_request *request, struct proto_problem *problem)
{
    if (!request->host && !request->is_http10)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST, "send a Host header");
    if (request->host && !host_is_allowed(config, request->host))
        return proto_problem_set(
            problem, PROTO_PROBLEM_FORBIDDEN,
            "the Host header names neither this machine nor a host that --allowed-host lists");
    if (server_guard_lists(config, request->origin)) return true;
    /* the daemon's own pages have an origin with the host and port of the request */
    const char *authority = request->origin ? strstr(request->origin, "://") : NULL;
    if (request->origin &&
        (!authority || !request->host || strcasecmp(authority + 3, request->host) != 0))
        return proto_problem_set(
            problem, PROTO_PROBLEM_FORBIDDEN,
            "pages of another origin can't use this service unless --cors-origin lists it");
    if (!*config->keys && request->fetch_site && strcasecmp(request->fetch_site, "cross-site") == 0)
        return proto_problem_set(problem, PROTO_PROBLEM_FORBIDDEN,
                                 "pages of another site can't use this service");
    return true;
}
