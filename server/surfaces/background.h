/* Background: a thread that computes results for surfaces, such as landmarks or previews. It
 * computes one result after the other, in idle time and in free memory.
 *
 * DESIGN. A surface has a *slot* for its result. A request that does not find the result queues the
 * slot. The thread takes the latest slot first, computes the result and stores it in the slot.
 * Results are items of a list (lru.h), whose mutex also guards the slots. A queued slot holds no
 * reference to its surface. A closed slot stays empty.
 *
 * When memory is short, the current build ends, and results are evicted. The thread has the
 * priority of a worker with a long job (thread_priority.h). While all workers are busy, the thread
 * sleeps ten times as long as it computes. */
#pragma once

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
    struct server_field_store *field_store; /* NULL means results are not stored */
};

struct server_build { /* A build of the result for one slot. */
    struct server_background *background;
    struct server_background_slot *slot;
    struct server_surface *surface; /* a reference */
    unsigned pressures;             /* value of `lru.pressures` at the start */
};

struct server_background { /* the owner sets the first members */
    struct server_lru lru; /* must be the first member; its budget is unset */
    struct server_background_parts parts;
    /* Computes the result, without the lock. Returns NULL on failure. */
    struct server_lru_item *(*make)(struct server_build *build);
    /* Called under the lock at the end of a build. `is_kept` is true if the result is in the
       slot. */
    void (*ended)(const struct server_build *build, bool is_kept);
    struct server_thread *thread;
    LIST_HEAD(, server_background_slot) waiting;
    struct server_background_slot *building;
};

/* Starts the thread. `background` was allocated by calloc, perhaps at the beginning of a larger
 * struct. Returns it. If there is no thread, frees it and returns NULL. */
struct server_background *server_background_start(struct server_background *background);

/* Stops the thread, after the last request. NULL is allowed, also in the next two functions. */
void server_background_stop(struct server_background *background);
void server_background_destroy(struct server_background *background); /* stops it first */

/* Called under the lock. Queues a slot that has no result. If it returns true, the caller must wake
 * the thread. */
bool server_background_queue(struct server_background *background,
                             struct server_background_slot *slot);

/* Returns true while a result is computed or a slot is queued. */
bool server_background_is_busy(struct server_background *background);

/* Begins the engine call that computes a result, with `grant` bytes of free memory. The call ends
 * early if the result is not needed any more or memory is short. */
struct server_budgeted_call server_build_begin_call(struct server_build *build, size_t grant);

/* Returns true if memory became short during the build. */
bool server_build_is_pressed(const struct server_build *build);
