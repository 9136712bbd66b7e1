/* Landmarks: distances of a mesh to a few vertices, which make searches of pairs narrower.
 *
 *     set = server_landmarks_find(landmarks, surface);                       NULL: none yet
 *     ... a search with set ? set->landmarks : NULL: the answer is the same ...
 *     server_landmark_set_release(set);
 *
 * DESIGN. A surface has a *slot*. The first search that finds it empty submits a background job
 * (workers.h), which reads the landmarks from the field store, or builds and stores them. Searches
 * go on without them meanwhile.
 *
 * Memory: the job uses only free memory. A set is SERVER_BUDGET_LANDMARKS until the last search
 * that uses it has ended. Under pressure a job that waits or runs is ended, and sets go, the least
 * recently used first: before fields and meshes, since a rebuild is cheapest. A slot that lost its
 * set pauses for many times what the set cost.
 *
 * Time: the job yields while it computes, but not while it reads, hashes and writes the file (64
 * bytes a vertex for 16 landmarks): this keeps its worker for milliseconds, once a mesh and start.
 *
 * One mutex guards slots and their order; the workers' lock is taken under it. All functions are
 * thread-safe. */
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

/* Becomes a reclaimer of the workspaces' budget. NULL without memory. */
struct server_landmarks *server_landmarks_create(const struct server_landmarks_parts *parts);
void server_landmarks_destroy(struct server_landmarks *landmarks); /* NULL is harmless */

/* The surface's set, to be released, or NULL: then a job is submitted, unless the mesh is small or
 * memory is short. `landmarks` NULL: there are none. Tens of nanoseconds. */
struct server_landmark_set *server_landmarks_find(struct server_landmarks *landmarks,
                                                  struct server_surface *surface);
void server_landmark_set_release(struct server_landmark_set *set); /* NULL is harmless */

struct server_landmarks_statistics {
    uint64_t built, loaded, dropped; /* sets */
};
/* `landmarks` NULL: zeros. */
struct server_landmarks_statistics server_landmarks_statistics(struct server_landmarks *landmarks);

#endif
