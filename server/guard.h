/* Guard: who may speak to a keyless daemon. A web page that its user visits can make the browser send requests to
 * loopback, also under a name of the page's own that it points there (DNS rebinding): so the name must be one of
 * ours and the page must not be foreign. */
#ifndef SERVER_GUARD_H
#define SERVER_GUARD_H

#include <stdbool.h>

#include "proto/problem.h"
#include "server/config.h"

struct server_guard {
    const struct server_config *config; /* borrowed */
};

/* The headers that tell, NULL where absent. */
struct server_guard_request {
    const char *host, *origin, *fetch_site;
    bool is_http10; /* may come without a Host */
};

/* True, or false with forbidden (invalid_request when HTTP/1.1 names no host). Thread-safe. */
bool server_guard_admit(const struct server_guard *guard, const struct server_guard_request *request,
                        struct proto_problem *problem);

#endif
