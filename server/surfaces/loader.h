/* Loader: loads stored surfaces and their stored fields into memory. If several jobs need the same
 * surface, one job loads it. The others are parked, and look up the surface again when the load
 * ends. After the start, the loader's thread loads the most used surfaces, as far as memory
 * permits. After that it stores the numbers of uses every minute.
 *
 * One mutex guards the list of current loads. All functions are thread-safe. */
#pragma once

#include "server/surfaces/field_store.h"
#include "server/work/workers.h"

struct server_loader_parts { /* all borrowed */
    struct server_budget *budget;
    /* where jobs are parked; a load ends when the workers are cancelled */
    struct server_workers *workers;
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_field_store *field_store; /* NULL means fields are not restored */
    uint32_t max_faces;
};

/* Creates a loader without a thread. Returns NULL if out of memory. */
struct server_loader *server_loader_create(const struct server_loader_parts *parts);

/* Starts the thread. Returns false if there is no memory or no thread. */
bool server_loader_preload(struct server_loader *loader);

/* Stops the thread, after the workers were cancelled. */
void server_loader_stop(struct server_loader *loader);
/* stops the loader and frees it; NULL is allowed */
void server_loader_destroy(struct server_loader *loader);

enum server_loader_outcome {
    SERVER_LOADER_LOADED,  /* the caller owns a reference of `*out` */
    SERVER_LOADER_WAITING, /* another job loads the surface, and this job is parked */
    /* the surface was replaced or removed: the caller looks up the name again */
    SERVER_LOADER_GONE,
    /* the problem is set; if memory is short, parked jobs are refused, too */
    SERVER_LOADER_FAILED
};

/* Fetches, verifies, builds and registers a surface for a job. If `job` is NULL, there is no
 * deadline and no wait. */
enum server_loader_outcome server_loader_load(struct server_loader *loader,
                                              struct server_record *record, struct server_job *job,
                                              struct server_surface **out,
                                              struct proto_problem *problem);

/* Parks a job if the record is being loaded. Returns false if it is not. */
bool server_loader_join(struct server_loader *loader, const struct server_record *record,
                        struct server_job *job);
