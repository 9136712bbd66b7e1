/* Field store: what was computed of meshes as files, so that a restart is warm: landmarks, written
 * when they have been built; and cached fields, written when the daemon stops and read when their
 * mesh is loaded.
 *
 *     fields/<version>-<etag>/<sha256>.field          the image of a field (gd/field.h), named by
 * its own checksum fields/<version>-<etag>/<sha256>.landmarks      the same of landmarks
 * (gd/landmarks.h); one at most
 *
 * What is here can be computed again: so nothing is synced, and a file that is not what its name
 * says, or is of another version or of a mesh that is gone, is deleted; one that can't be read at
 * the moment stays. They are read, not mapped: a page that the disk could not give back later would
 * end the process. Thread-safe but for server_field_store_save, which is called when nothing else
 * runs, and writing landmarks, which one thread does at a time. */
#ifndef SERVER_SURFACES_FIELD_STORE_H
#define SERVER_SURFACES_FIELD_STORE_H

#include "server/surfaces/registry.h"

struct server_field_store;

/* In `fields` of a local store's folder. NULL without memory, or if the folder can't be made. */
struct server_field_store *server_field_store_open(const char *folder,
                                                   struct server_budget *budget);
void server_field_store_close(struct server_field_store *store); /* NULL is harmless */

/* Puts the fields that are stored for this surface on its mesh cache, as far as the budget has room
 * without letting go of anything, and until the control (may be NULL) ends it, which it looks at
 * before each file. */
void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control);

/* Deletes what belongs to no surface of the registry, now and whenever one leaves it. */
void server_field_store_follow(struct server_field_store *store, struct server_registry *registry);

/* The stored landmarks of this surface, if there are that many; else NULL. Their
 * gd_landmarks_memsize bytes are taken as SERVER_BUDGET_FLIGHT, if the budget has room without
 * letting go of anything. */
struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count);

/* Writes the surface's landmarks in the place of those that are stored, as far as memory and disk
 * have room, and if the registry has the surface still. */
void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks);

/* Writes the fields of all surfaces that are in memory, until `until_ns`, and deletes those that
 * are no longer cached. */
void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns);

#endif
