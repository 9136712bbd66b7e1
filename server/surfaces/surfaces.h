/* Surfaces: the registry and all that is kept of surfaces, wired together.
 *
 * Order of creation, each part knowing only those before it: cache, registry (with the store),
 * field store, discretizations, landmarks, loader, scrub. */
#ifndef SERVER_SURFACES_SURFACES_H
#define SERVER_SURFACES_SURFACES_H

#include "server/config/config.h"
#include "server/surfaces/discretizations.h"
#include "server/surfaces/landmarks.h"
#include "server/surfaces/loader.h"
#include "server/surfaces/scrub.h"

struct server_surfaces {
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_workers *writer, *lister; /* one thread each, with queues that are never full */
    struct server_field_store *field_store; /* NULL: nothing is stored */
    struct server_landmarks *landmarks;     /* NULL: there are none */
    struct server_discretizations *discretizations;
    struct server_loader *loader;
    struct server_scrub *scrub; /* NULL: stored files are not verified */
};

struct server_surfaces_parts { /* all borrowed */
    const struct server_config *config;
    struct server_workers *workers;
    struct server_workspaces *workspaces;
    struct server_metrics *metrics;
};

/* Opens the store and creates all parts in `surfaces`, which is all zero and is not moved. False
 * with a sentence in `error`, which stays as it was without memory or threads; what was created is
 * for server_surfaces_destroy. */
bool server_surfaces_create(struct server_surfaces *surfaces,
                            const struct server_surfaces_parts *parts, char *error,
                            size_t error_size);

/* Ends the threads of loader and scrub, and stores the uses of surfaces and, if asked to, the
 * cached fields. When nothing else runs. */
void server_surfaces_persist(struct server_surfaces *surfaces, bool saves_fields);

/* After the workers were cancelled. */
void server_surfaces_destroy(struct server_surfaces *surfaces);

#endif
