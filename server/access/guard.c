/* See guard.h. */
#include "server/access/guard.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <string.h>
#include <strings.h>

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
    /* the origin of an own page names the host and port that the request is sent to */
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
