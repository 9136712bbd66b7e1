/* Landmarks: the distances from a few vertices of a mesh, which make searches for pairs shorter.
 *
 *     set = server_landmarks_find(landmarks, surface);                       NULL: none yet
 *     ... a search with set ? set->landmarks : NULL; both give the same answer ...
 *     server_landmark_set_release(set);
 *
 * DESIGN. A surface has a *slot* for its set of landmarks. The first search that finds the slot
 * empty queues it. Then a thread reads the landmarks from the field store, or builds and stores
 * them. Until then searches run without landmarks.
 *
 * Memory: the thread uses only free memory. A set counts as SERVER_BUDGET_LANDMARKS until the last
 * search that uses it has ended. Queued slots hold no reference of their surface. When memory is
 * short, the current build ends, and sets are evicted, the least recently used first. They are
 * evicted before fields and meshes, since rebuilding them is cheapest. A slot whose set was evicted
 * waits for many times the build time before the next build.
 *
 * Time: the thread has the priority of a worker with a long job (thread_priority.h). While all
 * workers are busy, it sleeps ten times as long as it computes.
 *
 * One mutex guards slots and their order. All functions are thread-safe. */
#ifndef SERVER_SURFACES_LANDMARKS_H
#define SERVER_SURFACES_LANDMARKS_H

#include "gd/landmarks.h"
#include "server/surfaces/surface.h"
#include "server/work/budgeted_call.h"

struct server_field_store;
struct server_metrics;
struct server_registry;
struct server_workers;

struct server_landmark_set {
    atomic_uint references;
    struct gd_landmarks *landmarks;
    struct server_budget *budget;
    size_t bytes;
};

struct server_landmarks_parts { /* all borrowed */
    struct server_workers *workers;
    struct server_workspaces *workspaces;
    struct server_metrics *metrics;
    struct server_registry *registry;
    struct server_field_store *field_store; /* NULL: sets are not stored */
    uint32_t count;                         /* landmarks of a mesh */
};

/* Becomes a reclaimer of the workspaces' budget and starts the thread. NULL: no memory or
 * thread. */
struct server_landmarks *server_landmarks_create(const struct server_landmarks_parts *parts);

/* Stops the thread, after the last search. NULL is harmless. */
void server_landmarks_stop(struct server_landmarks *landmarks);
void server_landmarks_destroy(struct server_landmarks *landmarks); /* NULL is harmless */

/* Returns the surface's set, to be released; or NULL, and queues a build unless the mesh is small
 * or memory is short. Also NULL if `landmarks` is NULL. Takes tens of nanoseconds. */
struct server_landmark_set *server_landmarks_find(struct server_landmarks *landmarks,
                                                  struct server_surface *surface);
void server_landmark_set_release(struct server_landmark_set *set); /* NULL is harmless */

struct server_landmarks_statistics {
    uint64_t built, loaded, dropped; /* sets */
    bool is_building;                /* or a slot is queued */
};
/* `landmarks` NULL: zeros. */
struct server_landmarks_statistics server_landmarks_statistics(struct server_landmarks *landmarks);

#endif
