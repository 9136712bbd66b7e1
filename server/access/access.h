/* Access: who sends a request, and whether he may. Without --keys everybody may (guard.h sees to
 * who that is). */
#ifndef SERVER_ACCESS_ACCESS_H
#define SERVER_ACCESS_ACCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/problem.h"
#include "proto/route.h"
#include "proto/writer.h"
#include "server/access/credentials.h"

struct server_access;

/* What an exchange has been granted, and holds until it ends; all zero: nothing. */
struct server_grant {
    struct server_credentials *keys;     /* counted: the set of `key` */
    const struct server_credential *key; /* NULL: none */
    bool is_entered;                     /* one of the key's concurrent requests */
};

/* Reads the keys of the file. NULL with a sentence in `error`. */
struct server_access *server_access_create(const char *path, char *error, size_t error_size);
void server_access_destroy(struct server_access *access); /* NULL is harmless */

/* Reads the file again. False with a sentence in `error`: the keys of before stay in force.
 * Thread-safe. */
bool server_access_reload(struct server_access *access, char *error, size_t error_size);

/* The headers that tell. */
struct server_access_request {
    const char *authorization; /* NULL: none */
    uint32_t authorization_count;
    enum proto_access needed;
};

/* True with `*grant` filled in, for the caller to end; or false with unauthorized, forbidden or
 * rate_limited, and with who was refused in `*grant`, to be ended too. `access` NULL, and what is
 * public: true, and nothing granted. Thread-safe. */
bool server_access_admit(struct server_access *access, const struct server_access_request *request,
                         struct server_grant *grant, struct proto_problem *problem);

/* The name of the key, for the log; NULL: none. */
const char *server_grant_name(const struct server_grant *grant);

/* Whose names the request is about (key.h), as long as the grant is held; "": nobody's. */
const char *server_grant_tenant(const struct server_grant *grant);

/* May the grant change what that key of its tenant has made? A key of the role write may change
 * whatever its tenant has, another one what it has made itself. False with forbidden. */
bool server_grant_may_change(const struct server_grant *grant, const char *key,
                             struct proto_problem *problem);

/* May it see what is of all tenants? Without keys everybody may. */
bool server_grant_is_operator(const struct server_grant *grant);

/* Another exchange goes on with the request, and is one of the concurrent ones in the other's
 * stead. */
void server_grant_pass(struct server_grant *from, struct server_grant *to);
void server_grant_end(struct server_grant *grant);

/* Requests and refusals by key, for Prometheus: of the keys of a tenant (NULL: of all). `access`
 * NULL is harmless. */
void server_access_write(struct server_access *access, const char *tenant,
                         struct proto_writer *writer);

#endif
