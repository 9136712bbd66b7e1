/* Loader: a stored surface comes back into memory, with its stored fields. */
#ifndef SERVER_SURFACES_LOADER_H
#define SERVER_SURFACES_LOADER_H

#include "server/server.h"
#include "server/surfaces/surface.h"

enum server_loader_outcome {
    SERVER_LOADER_LOADED,
    /* the key was replaced or removed meanwhile: look again; there is no problem */
    SERVER_LOADER_GONE,
    /* its bytes are missing, or not what was stored, or make no surface any more */
    SERVER_LOADER_DAMAGED,
    SERVER_LOADER_UNAVAILABLE, /* the store is out of reach */
    SERVER_LOADER_NO_MEMORY,   /* over the budget */
    SERVER_LOADER_ENDED        /* by its deadline or the daemon's drain */
};

/* Fetches, verifies, builds, and gives the surface to the registry; the caller has a reference of
 * its own. On failure `problem` tells what a client is told. One load of a record at a time: see
 * pending_loads.h. */
enum server_loader_outcome server_loader_load(struct server *server, struct server_record *record,
                                              uint64_t deadline_ns, struct server_surface **out,
                                              struct proto_problem *problem);

#endif
