/* Guard: from where one may speak to the daemon. A web page that its user visits can make the
 * browser send requests to loopback, also under a name of the page's own that it points there (DNS
 * rebinding): so, without keys, the name must be one of ours and the page must not be foreign. With
 * keys, which no browser sends by itself, the daemon may have any name unless some are listed.
 * Pages of the origins that --cors-origin lists may use it either way (CORS, Fetch standard, 3.2).
 */
#ifndef SERVER_ACCESS_GUARD_H
#define SERVER_ACCESS_GUARD_H

#include <stdbool.h>

#include "proto/problem.h"
#include "server/config/config.h"

struct server_guard {
    const struct server_config *config; /* borrowed */
};

/* The headers that tell, NULL where absent. */
struct server_guard_request {
    const char *host, *origin, *fetch_site;
    bool is_http10; /* may come without a Host */
};

/* Is it a page of a listed origin? NULL is none. Thread-safe. */
bool server_guard_lists(const struct server_guard *guard, const char *origin);

/* True, or false with forbidden (invalid_request when HTTP/1.1 names no host). Thread-safe. */
bool server_guard_admit(const struct server_guard *guard,
                        const struct server_guard_request *request, struct proto_problem *problem);

#endif
