/* Background: a thread that makes results for surfaces, such as landmarks or previews, one after
 * the other, in idle time and free memory.
 *
 * DESIGN. A surface has a *slot* for its result. A request that misses the result queues the slot;
 * the thread takes the latest one first, makes the result and puts it into the slot. Results are
 * items of a list (lru.h), whose mutex guards the slots, too. Queued slots hold no reference of
 * their surface; a closed slot stays empty.
 *
 * Memory: when it is short, the current build ends, and results are evicted. Time: the thread has
 * the priority of a worker with a long job (thread_priority.h). While all workers are busy, it
 * sleeps ten times as long as it computes. */
#ifndef SERVER_SURFACES_BACKGROUND_H
#define SERVER_SURFACES_BACKGROUND_H

#include "server/surfaces/surface.h"
#include "server/work/budgeted_call.h"
#include "server/work/workers.h"

struct server_field_store;
struct server_registry;
struct server_thread;

struct server_background_parts { /* all borrowed */
    struct server_workers *workers;
    struct server_workspaces *workspaces;
    struct server_registry *registry;
    struct server_field_store *field_store; /* NULL: results are not stored */
};

struct server_build { /* of the result for one slot */
    struct server_background *background;
    struct server_background_slot *slot;
    struct server_surface *surface; /* a reference */
    unsigned pressures;             /* `lru.pressures` at the start */
};

struct server_background { /* the first members are set by the owner */
    struct server_lru lru; /* first; without budget */
    struct server_background_parts parts;
    /* Makes the result, without the lock. NULL: it failed. */
    struct server_lru_item *(*make)(struct server_build *build);
    /* Called under the lock at the end of a build. `is_kept`: the slot has the result. */
    void (*ended)(const struct server_build *build, bool is_kept);
    struct server_thread *thread;
    LIST_HEAD(, server_background_slot) waiting;
    struct server_background_slot *building;
};

/* Starts the thread. Returns false if there is no memory or no thread. */
bool server_background_start(struct server_background *background);
void server_background_stop(struct server_background *background);
void server_background_end(struct server_background *background); /* stops it first */

/* Under the lock: queues a slot without a result. True: the caller wakes the thread. */
bool server_background_queue(struct server_background *background,
                             struct server_background_slot *slot);

/* Returns whether a result is being made, or a slot is queued. */
bool server_background_is_busy(struct server_background *background);

/* Begins the call of the engine that makes a result, with `grant` bytes of free memory. It ends
 * when the result is not needed any more, or memory is short. */
struct server_budgeted_call server_build_begin_call(struct server_build *build, size_t grant);

/* Returns whether memory became short during the build. */
bool server_build_is_pressed(const struct server_build *build);

#endif
