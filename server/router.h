/* Router: a request before and around its handler. */
#ifndef SERVER_ROUTER_H
#define SERVER_ROUTER_H

#include "server/exchange/exchange.h"

/* After the headers: sets the id, checks framing, Host and Origin, finds the route, checks the key
 * and decides about the body. If it replies (response.status is set), the body is not to be read
 * and the connection is to be closed. */
void server_router_begin(struct server_exchange *exchange);

/* After the body: calls the handler, or starts a job if the client prefers that. Returns with a
 * reply, or with `work` set: then the exchange is to be submitted. */
void server_router_end(struct server_exchange *exchange);

/* Calls the handler, with a deadline from now on. Returns as server_router_end does. */
void server_router_dispatch(struct server_exchange *exchange);

#endif
