/* Previews: simplified meshes for display. Queries always use the original mesh.
 *
 *     status = server_previews_find(previews, surface, faces, &preview, &progress);
 *     if (!status && preview) ... server_preview_release(preview);
 *
 * After the first request, a thread (background.h) reads the preview of the surface from the field
 * store, or simplifies the mesh and stores the result. Until the preview is ready, requests get the
 * progress. A preview with another number of faces replaces the cached preview. After a failed
 * build, one request gets the failure, and the next request queues the slot again. All functions
 * are thread-safe. */
#pragma once

#include "gd/polygons.h"
#include "server/surfaces/background.h"

#define SERVER_PREVIEW_FACES 100000 /* default number of faces */
/* the preview of a mesh with at least this many faces is made without a request */
#define SERVER_PREVIEW_FROM 300000

struct server_preview {
    struct server_lru_item item; /* must be the first member */
    uint32_t wanted;             /* requested number of faces; the preview may have slightly more */
    double largest_distance;     /* largest distance from the mesh, in the mesh's unit */
    struct gd_polygons polygons;
};

/* Starts the thread. Returns NULL if there is no memory or no thread. */
struct server_background *server_previews_create(const struct server_background_parts *parts);

/* Finds the preview with that number of faces. Returns GD_OK with the preview, which the caller
 * releases. If there is none yet, queues its build, unless that is already queued, and returns
 * GD_OK with NULL and the progress of the build. If the last build failed, returns its error. */
GD_MUST_USE enum gd_status server_previews_find(struct server_background *previews,
                                                struct server_surface *surface, uint32_t faces,
                                                struct server_preview **out, double *progress);
void server_preview_release(struct server_preview *preview); /* NULL is allowed */

/* Called after an upload: queues the preview of a large mesh. */
void server_previews_expect(struct server_background *previews, struct server_surface *surface);
