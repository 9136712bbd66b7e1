/* Router: the steps of a request before its handler. */
#ifndef SERVER_ROUTER_H
#define SERVER_ROUTER_H

#include "server/exchange/exchange.h"

/* Called after the headers: sets the id, checks framing, Host and Origin, finds the route, checks
 * the key and prepares the body. If it replies with response.close, the body is not read. */
void server_router_begin(struct server_exchange *exchange);

/* Called after the body: calls the handler, or starts a job if the client prefers that. Returns
 * with a reply, or with `work` set: then the caller submits the exchange. */
void server_router_end(struct server_exchange *exchange);

/* Sets the deadline and calls the handler. Returns as server_router_end. */
void server_router_dispatch(struct server_exchange *exchange);

#endif
