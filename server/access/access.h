/* Access: identifies the key that sends a request, and checks its rights and limits. Without --keys
 * everyone may do everything, but not from everywhere. */
#ifndef SERVER_ACCESS_ACCESS_H
#define SERVER_ACCESS_ACCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/problem.h"
#include "proto/http/route.h"
#include "proto/json/writer.h"
#include "server/access/credentials.h"
#include "server/config/config.h"

struct server_access;

/* What an exchange has been granted until it ends. All zero: nothing. */
struct server_grant {
    struct server_credentials *keys;     /* a reference: the set of `key` */
    const struct server_credential *key; /* NULL: none */
    bool is_entered;                     /* counts as one of the key's concurrent requests */
};

/* Reads the keys of the file. NULL with a sentence in `error`. */
struct server_access *server_access_create(const char *path, char *error, size_t error_size);
void server_access_destroy(struct server_access *access); /* NULL is harmless */

/* Reads the file again. False with a sentence in `error`: the present keys stay in force.
 * Thread-safe. */
bool server_access_reload(struct server_access *access, char *error, size_t error_size);

struct server_access_request {
    const char *authorization;    /* the header; NULL: none */
    uint32_t authorization_count; /* of such headers */
    enum proto_access needed;
};

/* Fills in `*grant`, which the caller ends in any case: a refused key is in it too. False with
 * unauthorized, forbidden or rate_limited. With `access` NULL, and for public routes: true, and
 * nothing is granted. Thread-safe. */
bool server_access_admit(struct server_access *access, const struct server_access_request *request,
                         struct server_grant *grant, struct proto_problem *problem);

/* The name of the key, for the log; NULL: none. */
const char *server_grant_name(const struct server_grant *grant);

/* The tenant of the request (kind.h), valid as long as the grant; "": none. */
const char *server_grant_tenant(const struct server_grant *grant);

/* Whether the grant may change what that key of its tenant has made. The role write may change all
 * of its tenant, other roles only what they made themselves. False with forbidden. */
bool server_grant_may_change(const struct server_grant *grant, const char *key,
                             struct proto_problem *problem);

/* Whether the grant may see all tenants. Without keys everyone may. */
bool server_grant_is_operator(const struct server_grant *grant);

/* Hands the request over to another exchange, which then is the concurrent one. Both are ended. */
void server_grant_pass(struct server_grant *from, struct server_grant *to);
void server_grant_end(struct server_grant *grant);

/* Appends requests and refusals by key, for Prometheus, of the keys of a tenant (NULL: of all).
 * `access` NULL is harmless. */
void server_access_write(struct server_access *access, const char *tenant,
                         struct proto_writer *writer);

/* From where a request may come. A web page can make its reader's browser send requests to
 * loopback, also under a name of its own that it points there (DNS rebinding). So without keys the
 * Host must be this machine's, and the page must be its own. Browsers don't send keys by
 * themselves: with keys any Host is accepted unless some are listed. Pages of the origins in
 * --cors-origin may use the daemon either way (CORS, Fetch standard, 3.2). */
/* Headers; NULL where absent. */
struct server_guard_request {
    const char *host, *origin, *fetch_site;
    bool is_http10; /* needs no Host */
};

/* Whether --cors-origin lists the origin. NULL: false. Thread-safe. */
bool server_guard_lists(const struct server_config *config, const char *origin);

/* False with forbidden, or with invalid_request when HTTP/1.1 names no host. Thread-safe. */
bool server_guard_admit(const struct server_config *config,
                        const struct server_guard_request *request, struct proto_problem *problem);

#endif
