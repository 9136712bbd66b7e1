/* Loader: brings a stored surface into memory, with its stored fields. */
#ifndef SERVER_SURFACES_LOADER_H
#define SERVER_SURFACES_LOADER_H

#include "server/surfaces/field_store.h"
#include "server/surfaces/registry.h"

struct server_loader { /* all borrowed */
    struct server_budget *budget;
    struct server_workers *workers; /* a load ends when they are cancelled */
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_field_store *field_store; /* NULL: fields are not restored */
    uint32_t max_faces;
};

enum server_loader_outcome {
    SERVER_LOADER_LOADED,
    SERVER_LOADER_GONE,        /* the key was replaced or removed: look again; no problem is set */
    SERVER_LOADER_DAMAGED,     /* its bytes are missing, or altered, or no longer make a surface */
    SERVER_LOADER_UNAVAILABLE, /* the store is out of reach */
    SERVER_LOADER_NO_MEMORY,   /* over the budget */
    SERVER_LOADER_ENDED        /* by its deadline or the daemon's drain */
};

/* Fetches, verifies and builds a surface, and gives it to the registry; the caller has a reference.
 * On failure sets the problem for the client. One load of a record at a time: see pending_loads.h.
 * `deadline_ns` 0: none. */
enum server_loader_outcome server_loader_load(const struct server_loader *loader,
                                              struct server_record *record, uint64_t deadline_ns,
                                              struct server_surface **out,
                                              struct proto_problem *problem);

#endif
