/* Deprecation: former names of paths and parameters, which the contract replaced. Requests that use
 * one are answered as if they used its replacement, with a header Deprecation (RFC 9745; reply.c
 * adds it). Handlers see new names only. */
#ifndef SERVER_EXCHANGE_DEPRECATION_H
#define SERVER_EXCHANGE_DEPRECATION_H

#include <stdbool.h>

struct proto_problem;
struct server_exchange;

/* Gives the parameters of a routed request their new names. invalid_request if a parameter stands
 * under its former name twice, or under both names. */
bool server_deprecation_apply(struct server_exchange *exchange, struct proto_problem *problem);

/* The name under which the client sent a parameter. */
const char *server_deprecation_sent(const struct server_exchange *exchange, const char *parameter);

#endif
