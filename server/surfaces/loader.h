/* Loader: loads stored surfaces and their stored fields into memory. Of several jobs that need the
 * same surface, one loads it; the others are parked and look it up again when the load ends. The
 * loader's thread loads the most used surfaces after the start, as far as memory permits, and then
 * stores the numbers of uses every minute.
 *
 * One mutex guards the list of current loads. All functions are thread-safe. */
#ifndef SERVER_SURFACES_LOADER_H
#define SERVER_SURFACES_LOADER_H

#include "server/surfaces/field_store.h"
#include "server/work/workers.h"

struct server_loader_parts { /* all borrowed */
    struct server_budget *budget;
    struct server_workers *workers; /* jobs are parked there; a load ends when they are cancelled */
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_field_store *field_store; /* NULL: fields are not restored */
    uint32_t max_faces;
};

/* Creates a loader without its thread. Returns NULL if out of memory. */
struct server_loader *server_loader_create(const struct server_loader_parts *parts);

/* Starts the thread. Returns false if there is no memory or no thread. */
bool server_loader_preload(struct server_loader *loader);

/* Stops the thread, after the workers were cancelled. */
void server_loader_stop(struct server_loader *loader);
void server_loader_destroy(struct server_loader *loader); /* stops it; NULL is allowed */

enum server_loader_outcome {
    SERVER_LOADER_LOADED,  /* the caller has a reference of `*out` */
    SERVER_LOADER_WAITING, /* another job loads it: this one is parked */
    SERVER_LOADER_GONE,    /* the surface was replaced or removed: look it up again */
    SERVER_LOADER_FAILED   /* with the problem; if memory is short, parked jobs are refused, too */
};

/* Fetches, verifies, builds and registers a surface for a job (NULL: no deadline, no wait). */
enum server_loader_outcome server_loader_load(struct server_loader *loader,
                                              struct server_record *record, struct server_job *job,
                                              struct server_surface **out,
                                              struct proto_problem *problem);

/* Parks a job if the record is being loaded; false: it is not. */
bool server_loader_join(struct server_loader *loader, const struct server_record *record,
                        struct server_job *job);

#endif
