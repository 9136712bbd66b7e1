/* Handlers, one for each operation of proto/openapi.yaml. An HTTP thread calls a handler with a
 * whole request. The handler ends with a reply or with server_exchange_defer (exchange.h). */
#pragma once

#include "generated/handlers.h"
#include "server/exchange/exchange.h"

/* Handles any operation with Prefer: respond-async. */
void server_handle_async(struct server_exchange *exchange);
