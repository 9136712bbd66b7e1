/* See surface.h. */
#include "server/surface.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct server_surface *server_surface_create(const struct server_surface_origin *origin, struct gd_mesh *mesh,
                                             size_t bytes, struct server_budget *budget, struct server_cache *cache)
{
    struct server_surface *surface = malloc(sizeof *surface);
    struct server_shelf *shelf = server_shelf_open(cache);
    if (!surface || !shelf) {
        if (shelf) server_shelf_release(shelf);
        free(surface);
        return NULL;
    }
    *surface = (struct server_surface){.references = 1,
                                       .origin = *origin,
                                       .created = time(NULL),
                                       .mesh = mesh,
                                       .bytes = bytes,
                                       .budget = budget,
                                       .shelf = shelf};
    server_surface_etag(origin, surface->etag);
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_MESHES, bytes);
    return surface;
}

struct server_surface *server_surface_retain(struct server_surface *surface)
{
    atomic_fetch_add(&surface->references, 1);
    return surface;
}

void server_surface_release(struct server_surface *surface)
{
    if (!surface || atomic_fetch_sub(&surface->references, 1) != 1) return;
    server_shelf_close(surface->shelf);
    server_shelf_release(surface->shelf);
    gd_mesh_release(surface->mesh);
    server_budget_give(surface->budget, SERVER_BUDGET_MESHES, surface->bytes);
    free(surface);
}

void server_surface_retire(struct server_surface *surface)
{
    server_shelf_close(surface->shelf);
}

bool server_surface_origin_equal(const struct server_surface_origin *a, const struct server_surface_origin *b)
{
    return strcmp(a->sha256, b->sha256) == 0 && proto_mesh_options_equal(&a->options, &b->options);
}

void server_surface_etag(const struct server_surface_origin *origin, char etag[SERVER_ETAG])
{
    char text[SERVER_SHA256_HEX + 64], hex[SERVER_SHA256_HEX];
    int size = snprintf(text, sizeof text, "%s format=%d triangulate=%d", origin->sha256, (int)origin->options.format,
                        !origin->options.build.refuse_polygons);
    server_sha256(text, (size_t)size, hex);
    snprintf(etag, SERVER_ETAG, "%.32s", hex);
}
