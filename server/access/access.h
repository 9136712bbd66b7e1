/* Access: identifies the key of a request, and checks its rights and limits. Without --keys every
 * client has all rights, except that requests of foreign web pages are refused. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "proto/json/problem.h"
#include "proto/http/route.h"
#include "proto/json/writer.h"
#include "server/access/credentials.h"
#include "server/config/config.h"

struct server_access;

/* The rights of an exchange until it ends. All zero means no rights. */
struct server_grant {
    struct server_credentials *keys;     /* a reference to the set that contains `key` */
    const struct server_credential *key; /* NULL means no key */
    bool is_entered; /* true if the request counts among the key's concurrent requests */
};

/* Reads the keys of the file. Each tenant gets a share of the budget (work/budget.h). Returns NULL
 * with a sentence in `error` on failure. */
struct server_access *server_access_create(const char *path, struct server_budget *budget,
                                           char error[SERVER_ERROR]);
void server_access_destroy(struct server_access *access); /* NULL is allowed */

/* Reads the file again. On failure returns false with a sentence in `error`; the old keys stay in
 * use. For one thread at a time, while other threads admit requests. */
bool server_access_reload(struct server_access *access, char error[SERVER_ERROR]);

struct server_access_request {
    const char *authorization;    /* the header; may be NULL */
    uint32_t authorization_count; /* number of such headers */
    enum proto_access needed;
    /* true if the request only reads or ends jobs or batches: it takes no place among the key's
     * concurrent requests, so that a key whose jobs take all places can follow and cancel them */
    bool is_follow_up;
};

/* Fills in `*grant`, also if the key is refused; the caller always ends the grant. Returns false
 * with unauthorized, forbidden or rate_limited. Returns true with an empty grant if `access` is
 * NULL or the route is public. Thread-safe. */
bool server_access_admit(struct server_access *access, const struct server_access_request *request,
                         struct server_grant *grant, struct proto_problem *problem);

/* Returns the name of the key, for the log, or NULL if there is none. */
const char *server_grant_name(const struct server_grant *grant);

/* Returns the tenant of the request (kind.h), or "" if there is none. Valid as long as the
 * grant. */
const char *server_grant_tenant(const struct server_grant *grant);

/* Returns whether the grant may change jobs, batches and fields of `key`, a key of its tenant. A
 * grant with the role write may change those of all keys of its tenant, any other grant only those
 * of its own key. On refusal sets the problem forbidden. */
bool server_grant_may_change(const struct server_grant *grant, const char *key,
                             struct proto_problem *problem);

/* Returns whether the grant may see all tenants. Returns true if the daemon has no keys. */
bool server_grant_is_operator(const struct server_grant *grant);

/* Copies the grant. From then on `to`, instead of `from`, counts as a concurrent request. The
 * caller must end both grants. */
void server_grant_pass(struct server_grant *from, struct server_grant *to);
void server_grant_end(struct server_grant *grant);

/* Appends the numbers of requests and refusals of a tenant's keys. If `tenant` is NULL, appends
 * those of all keys. `access` may be NULL. */
void server_access_write(struct server_access *access, const char *tenant,
                         struct proto_writer *writer);

/* The guard checks where a request comes from. A web page can make a browser send requests to
 * loopback, even under the page's own host name (DNS rebinding). So without keys the Host must name
 * this machine, and the Origin must name the daemon. With keys any Host is accepted, because
 * browsers never add a key by themselves. If --allowed-host lists hosts, only those and this
 * machine are accepted. Pages of the origins in --cors-origin may always use the daemon (CORS,
 * Fetch standard, 3.2).
 *
 * The members are headers. NULL means that the request has no such header. */
struct server_guard_request {
    const char *host, *origin, *fetch_site;
    bool is_http10; /* true if the request may omit Host */
};

/* Returns whether --cors-origin lists the origin; false for NULL. Thread-safe. */
bool server_guard_lists(const struct server_config *config, const char *origin);

/* Checks Host and Origin. Returns false with the problem forbidden, or invalid_request if there is
 * no host. Thread-safe. */
bool server_guard_admit(const struct server_config *config,
                        const struct server_guard_request *request, struct proto_problem *problem);
