/* Previews: thinned meshes for display. The original answers all queries.
 *
 *     status = server_previews_find(previews, surface, faces, &preview, &progress);
 *     if (!status && preview) ... server_preview_release(preview);
 *
 * A thread (background.h) makes the preview of a surface after the first request: it reads it from
 * the field store, or thins the mesh and stores the result. Until then requests get the progress. A
 * preview with another number of faces replaces the cached preview. One request gets the failure of
 * a build; the next one queues the slot again. All functions are thread-safe. */
#ifndef SERVER_SURFACES_PREVIEWS_H
#define SERVER_SURFACES_PREVIEWS_H

#include "gd/polygons.h"
#include "server/surfaces/background.h"

#define SERVER_PREVIEW_FACES 100000 /* default number of faces */
/* from so many faces on, a mesh's preview is made without a request */
#define SERVER_PREVIEW_FROM 300000

struct server_preview {
    struct server_lru_item item; /* must be the first member */
    uint32_t wanted;             /* faces; the preview may have slightly more */
    double largest_distance;     /* from the mesh, in its unit */
    struct gd_polygons polygons;
};

/* Starts the thread. Returns NULL if there is no memory or no thread. */
struct server_previews *server_previews_create(const struct server_background_parts *parts);

/* Stops the thread, after the last request. NULL is allowed. */
void server_previews_stop(struct server_previews *previews);
void server_previews_destroy(struct server_previews *previews); /* NULL is allowed */

/* Finds the preview with that number of faces. Returns GD_OK with the preview, which the caller
 * releases. If there is none yet, queues its build if need be, and returns GD_OK with NULL and the
 * progress of the build. Returns the error of the last build if that failed. */
GD_MUST_USE enum gd_status server_previews_find(struct server_previews *previews,
                                                struct server_surface *surface, uint32_t faces,
                                                struct server_preview **out, double *progress);
void server_preview_release(struct server_preview *preview); /* NULL is allowed */

/* Called after an upload: queues the preview of a large mesh. */
void server_previews_expect(struct server_previews *previews, struct server_surface *surface);

/* Returns whether a preview is being made or read. NULL: false. */
bool server_previews_are_building(struct server_previews *previews);

#endif
