/* Guard: from where a request may come. A web page can make its reader's browser send requests to
 * loopback, also under a name of its own that it points there (DNS rebinding). So without keys the
 * Host must be this machine's, and the page must be its own. Browsers don't send keys by
 * themselves: with keys any Host is accepted unless some are listed. Pages of the origins in
 * --cors-origin may use the daemon either way (CORS, Fetch standard, 3.2). */
#ifndef SERVER_ACCESS_GUARD_H
#define SERVER_ACCESS_GUARD_H

#include <stdbool.h>

#include "proto/json/problem.h"
#include "server/config/config.h"

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
