/* Prefer: what a client would like but does not insist on (RFC 7240). */
#ifndef SERVER_EXCHANGE_PREFER_H
#define SERVER_EXCHANGE_PREFER_H

#include "server/exchange/exchange.h"

/* True when a Prefer header lists `preference`, any case, without a value or with an empty one. */
bool server_prefers(const struct server_exchange *exchange, const char *preference);

#endif
