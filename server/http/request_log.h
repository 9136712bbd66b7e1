/* Request log: the line that each answered request leaves. */
#ifndef SERVER_HTTP_REQUEST_LOG_H
#define SERVER_HTTP_REQUEST_LOG_H

#include <stdint.h>
#include <sys/socket.h>

struct server_exchange;

/* Logs an answered exchange, which took that long, as `request`, or with a warning as
 * `slow_request` where that is
 * --slow-ms or more. `peer` is its client's address (may be NULL), told only where an operator
 * would look for it: with what was malformed or refused. No key is ever logged, but the name of the
 * key. */
void server_request_log(const struct server_exchange *exchange, const struct sockaddr *peer,
                        uint64_t nanoseconds);

#endif
