/* Pending builds: fields that are being built, each by one, and the jobs that wait for them. Not
 * thread-safe: the cache's lock guards them. */
#ifndef SERVER_FIELDS_PENDING_BUILDS_H
#define SERVER_FIELDS_PENDING_BUILDS_H

#include "server/fields/field_key.h"
#include "server/work/lanes.h"

struct server_mesh_cache;

struct server_pending_build {
    struct server_mesh_cache *fields; /* that it lands on; its starter has the reference */
    struct server_pending_build *next;
    struct server_field_key key; /* owned */
    struct server_job *parked;
};

struct server_pending_builds { /* all zero is none; as many as jobs can be queued or run at most */
    struct server_pending_build *first;
};

/* Of the pending builds to that mesh cache of that key, reaching no farther, the one that reaches
 * farthest; or NULL. */
struct server_pending_build *server_pending_builds_find(const struct server_pending_builds *builds,
                                                        const struct server_mesh_cache *fields,
                                                        const struct server_field_key *key);

/* A new one with nobody waiting; the key is copied. NULL without memory. */
struct server_pending_build *server_pending_builds_start(struct server_pending_builds *builds,
                                                         struct server_mesh_cache *fields,
                                                         const struct server_field_key *key);

void server_pending_build_park(struct server_pending_build *build, struct server_job *job);

/* Takes the pending build out of the list; its parked jobs and its key go with
 * server_pending_build_free. */
void server_pending_builds_end(struct server_pending_builds *builds,
                               struct server_pending_build *build);

/* Frees a pending build that has ended and returns the jobs that were parked on it. */
struct server_job *server_pending_build_free(struct server_pending_build *build);

/* Takes the parked jobs that are late out of all pending builds and returns them as a list. */
struct server_job *server_pending_builds_expire(struct server_pending_builds *builds,
                                                uint64_t now_ns);

#endif
