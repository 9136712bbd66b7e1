/* See store.h: the store that keeps nothing. */
#include <stdlib.h>

#include "server/store/store.h"

static enum server_store_outcome each(struct server_store *store,
                                      bool (*visit)(void *user, const struct server_stored *stored),
                                      void *user)
{
    (void)store, (void)visit, (void)user;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome put(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version)
{
    (void)store, (void)record, (void)content, (void)version;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome keep(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content)
{
    (void)store, (void)record, (void)content;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome forget(struct server_store *store,
                                        const struct server_record *record, uint64_t *version)
{
    (void)store, (void)record, (void)version;
    return SERVER_STORE_DONE;
}

static void tidy(struct server_store *store)
{
    (void)store;
}

static void note_uses(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count)
{
    (void)store, (void)records, (void)uses, (void)count;
}

static const char *health(struct server_store *store)
{
    (void)store;
    return NULL;
}

static void destroy(struct server_store *store)
{
    free(store);
}

struct server_store *server_store_memory_create(void)
{
    struct server_store *store = malloc(sizeof *store);
    if (!store) return NULL;
    *store = (struct server_store){.each = each,
                                   .put = put,
                                   .keep = keep,
                                   .remove = forget,
                                   .tidy = tidy,
                                   .note_uses = note_uses,
                                   .health = health,
                                   .close = destroy};
    return store;
}
