/* Field store: files of what was computed of meshes, so that a restart is warm: landmarks, written
 * when they are built, and cached fields, written when the daemon stops and read when their mesh is
 * loaded.
 *
 *     fields/<version>-<etag>/<sha256>.field        the image of a field (gd/field.h)
 *     fields/<version>-<etag>/<sha256>.landmarks    the image of landmarks (gd/landmarks.h); one
 *
 * Nothing is synced. A file that does not match its name, or is of another version or of a mesh
 * that is gone, is deleted; one that can't be read at the moment stays. Files are read, not mapped:
 * a page that the disk can't deliver would end the process. Thread-safe but for
 * server_field_store_save, which is called when nothing else runs, and
 * server_field_store_write_landmarks, which one thread calls at a time. */
#ifndef SERVER_SURFACES_FIELD_STORE_H
#define SERVER_SURFACES_FIELD_STORE_H

#include "gd/landmarks.h"
#include "server/surfaces/registry.h"

struct server_field_store;

/* In `fields` of a local store's folder; both are borrowed. NULL without memory, or if the folder
 * can't be made. */
struct server_field_store *server_field_store_open(const char *folder,
                                                   struct server_budget *budget);
void server_field_store_close(struct server_field_store *store); /* NULL is harmless */

/* Deletes the files of surfaces that the registry does not have, now and whenever one leaves it. */
void server_field_store_follow(struct server_field_store *store, struct server_registry *registry);

/* Puts the stored fields of a surface into its mesh cache, as far as free memory allows, until the
 * control (may be NULL), which is checked before each file, ends it. */
void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control);

/* Writes the fields of all surfaces in memory, until `until_ns`, and deletes the files of fields
 * that are no longer cached. */
void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns);

/* The stored landmarks of a surface if there are `count`; else NULL. Their gd_landmarks_memsize
 * bytes are taken from free memory as SERVER_BUDGET_FLIGHT. */
struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count);

/* Replaces the stored landmarks of a surface, as far as free memory and disk allow, if the registry
 * still has the surface. */
void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks);

#endif
