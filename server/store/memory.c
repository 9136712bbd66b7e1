/* The store that stores nothing: see store.h. */
#include <stdlib.h>

#include "server/store/store.h"

static void memory_close(struct server_store *store)
{
    free(store);
}

struct server_store *server_store_memory_create(void)
{
    struct server_store *store = calloc(1, sizeof *store);
    if (store) store->close = memory_close;
    return store;
}
