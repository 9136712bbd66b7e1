/* Field store: files of data that was computed from meshes. A restarted daemon reads the files
 * instead of computing the data again. Landmarks and previews are written when they are built.
 * Cached fields are written when the daemon stops, and read when their mesh is loaded.
 *
 *     fields/<version>-<etag>/<sha256>.field        the image of a field (gd/field.h)
 *     fields/<version>-<etag>/<sha256>.landmarks    landmarks (gd/landmarks.h); one file
 *     fields/<version>-<etag>/<sha256>.preview      a simplified mesh (previews.h); one file
 *
 * Files are not synced. A file is deleted if it does not match its name, or belongs to another
 * version or to a removed mesh. A file that can't be read at the moment is kept. Files are read,
 * not mapped, because a page that the disk can't deliver would end the process. Thread-safe, with
 * these exceptions: server_field_store_save is called when nothing else runs, and one thread at a
 * time writes landmarks or previews. */
#pragma once

#include "gd/landmarks.h"
#include "gd/polygons.h"
#include "server/surfaces/registry.h"

struct server_field_store;

/* Opens the folder `fields` in a local store's folder. Borrows both arguments. Returns NULL if the
 * folder can't be made. */
struct server_field_store *server_field_store_open(const char *folder,
                                                   struct server_budget *budget);
void server_field_store_close(struct server_field_store *store); /* NULL is allowed */

/* Deletes the files of surfaces that are not in the registry, now and whenever a surface leaves the
 * registry. */
void server_field_store_follow(struct server_field_store *store, struct server_registry *registry);

/* Loads the stored fields of a surface into its mesh cache, as far as free memory permits. Checks
 * the control (may be NULL) before each file. */
void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control);

/* Writes the fields of all surfaces, until `until_ns`. Deletes the files of fields that are no
 * longer cached. */
void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns);

/* Returns the stored landmarks of a surface if their number is `count`, otherwise NULL. Takes their
 * bytes (gd_landmarks_memsize) from free memory, and counts them as SERVER_BUDGET_FLIGHT. */
struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count);

/* Replaces the stored landmarks of a surface in the registry, if memory and disk have room. */
void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks);

/* A simplified mesh (previews.h). */
struct server_stored_preview {
    uint32_t wanted; /* faces */
    double largest_distance;
    struct gd_polygons polygons;
    size_t bytes; /* bytes of the polygons */
};

/* Reads the stored preview of a surface if it has `preview->wanted` faces. The caller owns the
 * polygons. Takes their bytes from free memory, and counts them as SERVER_BUDGET_FLIGHT. Returns
 * false if there is no such preview or memory is short. */
bool server_field_store_read_preview(struct server_field_store *store,
                                     const struct server_surface *surface,
                                     struct server_stored_preview *preview);

/* Like server_field_store_write_landmarks, but writes the preview. */
void server_field_store_write_preview(struct server_field_store *store,
                                      struct server_registry *registry,
                                      const struct server_surface *surface,
                                      const struct server_stored_preview *preview);
