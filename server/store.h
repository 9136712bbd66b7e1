/* Store: the surfaces by name. What a back-end must do; registry.c keeps them in memory.
 *
 * All calls are thread-safe. A name has one surface at a time; what is put is seen by the next get. Surfaces that
 * go (replaced or removed) are retired by the store and live on for those who hold them. */
#ifndef SERVER_STORE_H
#define SERVER_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/surface.h"

/* RFC 9110, 13: If-Match and If-None-Match as the client sent them; NULL: absent. */
struct server_precondition {
    const char *if_match, *if_none_match;
};

/* Does it hold for a resource of that entity tag (without quotes; NULL: there is no such resource)? */
bool server_precondition_holds(const struct server_precondition *precondition, const char *etag);

enum server_store_outcome {
    SERVER_STORE_CREATED,
    SERVER_STORE_REPLACED,
    SERVER_STORE_REMOVED,
    SERVER_STORE_ABSENT,
    SERVER_STORE_PRECONDITION, /* it does not hold; nothing changed */
    SERVER_STORE_NO_MEMORY     /* nothing changed */
};

struct server_store {
    /* Stores a surface under its name, together with the bytes that it was made from (borrowed). The store takes a
     * reference of its own. */
    enum server_store_outcome (*put)(struct server_store *store, struct server_surface *surface, const void *bytes,
                                     size_t size, const struct server_precondition *precondition);
    /* The surface of that name, retained, or NULL. */
    struct server_surface *(*get)(struct server_store *store, const char *name);
    enum server_store_outcome (*remove)(struct server_store *store, const char *name,
                                        const struct server_precondition *precondition);
    /* Up to `most` surfaces with names after `after` (NULL: from the first), in byte order, each retained, into
     * `out`; returns how many. */
    uint32_t (*list)(struct server_store *store, const char *after, uint32_t most, struct server_surface **out);
    uint32_t (*count)(struct server_store *store);
    void (*close)(struct server_store *store); /* retires and releases all, frees the store */
};

#endif
