/* See store.h: the store that keeps nothing. */
#include <stdlib.h>

#include "server/store/store.h"

static enum server_store_outcome nothing_each(struct server_store *store,
                                              server_stored_visit *visit, void *user)
{
    (void)store, (void)visit, (void)user;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome nothing_put(struct server_store *store,
                                             const struct server_record *record,
                                             const struct server_content *content,
                                             uint64_t *version)
{
    (void)store, (void)record, (void)content, (void)version;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome nothing_keep(struct server_store *store,
                                              const struct server_record *record,
                                              const struct server_content *content)
{
    (void)store, (void)record, (void)content;
    return SERVER_STORE_DONE;
}

static enum server_store_outcome
nothing_remove(struct server_store *store, const struct server_record *record, uint64_t *version)
{
    (void)store, (void)record, (void)version;
    return SERVER_STORE_DONE;
}

static void nothing_tidy(struct server_store *store)
{
    (void)store;
}

static void nothing_note_uses(struct server_store *store,
                              const struct server_record *const *records,
                              const struct server_store_uses *uses, uint32_t count)
{
    (void)store, (void)records, (void)uses, (void)count;
}

static const char *nothing_health(struct server_store *store)
{
    (void)store;
    return NULL;
}

static void nothing_close(struct server_store *store)
{
    free(store);
}

const struct server_store server_store_nothing = {.each = nothing_each,
                                                  .put = nothing_put,
                                                  .keep = nothing_keep,
                                                  .remove = nothing_remove,
                                                  .tidy = nothing_tidy,
                                                  .note_uses = nothing_note_uses,
                                                  .health = nothing_health,
                                                  .close = nothing_close};

struct server_store *server_store_memory_create(void)
{
    struct server_store *store = malloc(sizeof *store);
    if (store) *store = server_store_nothing;
    return store;
}
