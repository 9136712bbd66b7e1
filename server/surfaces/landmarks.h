/* Landmarks: the distances from a few vertices of a mesh. They make searches for pairs faster.
 *
 *     set = server_landmarks_find(landmarks, surface); may be NULL
 *     ... a search with set ? set->landmarks : NULL; both give the same answer ...
 *     server_landmark_set_release(set);
 *
 * After the first search without landmarks, a thread (background.h) reads the landmarks of the
 * surface from the field store, or builds and stores them. Sets are evicted before fields and
 * meshes, because rebuilding a set is cheaper. After the set of a slot was evicted, the next build
 * waits many times as long as the last build took. All functions are thread-safe. */
#pragma once

#include "gd/landmarks.h"
#include "server/surfaces/background.h"

struct server_metrics;

struct server_landmark_set {
    struct server_lru_item item; /* must be the first member */
    struct gd_landmarks *landmarks;
};

/* Starts the thread. It builds `count` landmarks for each mesh. Returns NULL if there is no memory
 * or no thread. */
struct server_background *server_landmarks_create(const struct server_background_parts *parts,
                                                  struct server_metrics *metrics, uint32_t count);

/* Returns the surface's set, which the caller releases. If there is none, returns NULL, and queues
 * a build unless the mesh is small or memory is short. Also returns NULL if `landmarks` is NULL.
 * Cost: tens of nanoseconds. */
struct server_landmark_set *server_landmarks_find(struct server_background *landmarks,
                                                  struct server_surface *surface);
void server_landmark_set_release(struct server_landmark_set *set); /* NULL is allowed */

struct server_landmarks_statistics {
    uint64_t built, loaded, dropped; /* sets */
};
/* Returns zeros if `landmarks` is NULL. */
struct server_landmarks_statistics server_landmarks_statistics(struct server_background *landmarks);
