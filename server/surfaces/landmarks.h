/* Landmarks: of each surface that pairs are searched on, so that the later searches are narrower.
 *
 *     const struct server_landmark_set *set = server_landmarks_find(server->landmarks, surface);
 * NULL: none yet
 *     ... a search with set ? set->landmarks : NULL: the answer is the same ...
 *     server_landmark_set_release(set);
 *
 * DESIGN. A surface has a *slot*. The first search that finds it empty submits a background job
 * (workers.h), which reads the landmarks from the field store, or builds them and writes them
 * there, and puts them into the slot. Searches go on without meanwhile.
 *
 * Memory: the job makes do with what is free; a set is SERVER_BUDGET_LANDMARKS until the last
 * search that uses it has ended. Under pressure, a job that waits or runs is ended, and sets go,
 * those that were not used for longest first: all this before fields and meshes, since it takes
 * least to have them again. What went comes back after a pause of many times what it costs, so that
 * a full daemon does not spend its idle time on this.
 *
 * Time: the job yields while it computes (workers.h), but not while it reads, hashes and writes the
 * file, 64 bytes a vertex for 16 landmarks: this keeps its worker for 2 to 4 ms for each 16,000
 * vertices, once a mesh, and once a mesh after a restart.
 *
 * One mutex guards slots and their order; under it nothing calls out. All functions are
 * thread-safe. */
#ifndef SERVER_SURFACES_LANDMARKS_H
#define SERVER_SURFACES_LANDMARKS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "gd/landmarks.h"
#include "server/work/budget.h"

struct server;
struct server_surface;
struct server_landmarks;

struct server_landmark_set {
    atomic_uint references;
    struct gd_landmarks *landmarks;
    struct server_budget *budget;
    size_t bytes;
};

/* Of one surface; all-zero: empty. */
struct server_landmark_slot {
    _Atomic(struct server_landmarks *) owner; /* NULL: never asked for */
    atomic_bool is_closed;
    /* under the owner's lock: */
    /* the job that is to bring a set, until it begins */
    struct server_job *waiting;
    struct server_landmark_set *set; /* NULL: empty */
    /* neighbours in the order of use, while there is a set */
    struct server_landmark_slot *colder, *warmer;
    bool is_coming;         /* a job brings a set */
    uint64_t cost_ns;       /* of what the last job did */
    uint64_t not_before_ns; /* when the next one may begin */
};

/* Becomes a part of the server's budget, to reclaim from. The server, whose configuration says how
 * many landmarks a mesh gets, is borrowed. NULL without memory. */
struct server_landmarks *server_landmarks_create(struct server *server);

/* All slots are closed and no job is left. NULL is harmless. */
void server_landmarks_destroy(struct server_landmarks *landmarks);

/* The surface's set, to be released, or NULL; then it is brought, unless the mesh is small or
 * memory is short. `landmarks` NULL: there are none. Tens of nanoseconds. */
struct server_landmark_set *server_landmarks_find(struct server_landmarks *landmarks,
                                                  struct server_surface *surface);
void server_landmark_set_release(struct server_landmark_set *set); /* NULL is harmless */

/* Empties the slot for good; a second time is harmless. */
void server_landmark_slot_close(struct server_landmark_slot *slot);

struct server_landmarks_statistics {
    uint64_t built, loaded, dropped; /* sets */
};
/* `landmarks` NULL: zeros. */
struct server_landmarks_statistics server_landmarks_statistics(struct server_landmarks *landmarks);

#endif
