/* Loader: brings stored surfaces into memory, with their stored fields. Each is loaded once however
 * many jobs ask for it: the others are parked, and resumed to look again when the load ends. Its
 * thread loads the most used surfaces after the start, as far as memory has room, and then stores
 * every minute how often surfaces were used.
 *
 * One mutex guards the list of loads under way. All functions are thread-safe. */
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

/* Without its thread. NULL without memory. */
struct server_loader *server_loader_create(const struct server_loader_parts *parts);

/* Starts the thread; false without memory or thread. */
bool server_loader_preload(struct server_loader *loader);

/* Stops the thread, after the workers were cancelled. */
void server_loader_stop(struct server_loader *loader);
void server_loader_destroy(struct server_loader *loader); /* stops it; NULL is harmless */

enum server_loader_outcome {
    SERVER_LOADER_LOADED,  /* the caller has a reference of `*out` */
    SERVER_LOADER_WAITING, /* another job loads it: this one is parked */
    SERVER_LOADER_GONE,    /* the key was replaced or removed: look again */
    SERVER_LOADER_FAILED   /* with the problem; without memory the parked jobs are refused, too */
};

/* Fetches, verifies and builds a surface on behalf of a job (NULL: without deadline, and without
 * waiting), and gives it to the registry. */
enum server_loader_outcome server_loader_load(struct server_loader *loader,
                                              struct server_record *record, struct server_job *job,
                                              struct server_surface **out,
                                              struct proto_problem *problem);

/* Parks a job if the record is being loaded; false: it is not. */
bool server_loader_join(struct server_loader *loader, const struct server_record *record,
                        struct server_job *job);

#endif
