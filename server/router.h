/* Router: what happens to a request before and around its handler. */
#ifndef SERVER_ROUTER_H
#define SERVER_ROUTER_H

#include "server/http/exchange.h"

/* After the headers: identifies, checks the framing, admits, finds the route, decides on the body.
 * If it has replied (response.status is set), a body that was announced is not to be read, and the
 * connection is to be closed. */
void server_router_begin(struct server_exchange *exchange);

/* After the body: unless there is a reply already, has the operation done, or makes a job of it
 * when that is what the client prefers. Returns with a reply, or with `work` set: then the exchange
 * is to be submitted. */
void server_router_end(struct server_exchange *exchange);

/* Calls the handler, with a deadline from now on. Returns as server_router_end does. */
void server_router_dispatch(struct server_exchange *exchange);

#endif
