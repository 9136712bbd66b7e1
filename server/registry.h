/* Registry: the store that keeps surfaces in memory only. */
#ifndef SERVER_REGISTRY_H
#define SERVER_REGISTRY_H

#include "server/store.h"

/* An empty store, closed by its own `close`. NULL without memory. */
struct server_store *server_registry_create(void);

#endif
