/* Surface: an object of some kind in memory, a mesh for instance, with its record, its attachment,
 * its fields and its landmarks.
 *
 * Immutable but for its count, its mesh cache and its slot. The mesh cache holds fields, which hold
 * the mesh, and so do landmarks: retiring the surface closes both. */
#ifndef SERVER_SURFACES_SURFACE_H
#define SERVER_SURFACES_SURFACE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "gd/mesh.h"
#include "server/fields/cache.h"
#include "server/surfaces/landmarks.h"
#include "server/store/record.h"

struct server_surface {
    atomic_uint references;
    struct server_record *record;
    union { /* of record->kind */
        void *object;
        struct gd_mesh *mesh;
    };
    void *attachment; /* record->attachment_size bytes, owned; NULL: there is none */
    size_t bytes;     /* of both, in SERVER_BUDGET_MESHES until the last reference goes */
    struct server_budget *budget;
    struct server_mesh_cache *fields;
    struct server_landmark_slot landmarks;
};

/* Takes over the object, which is of the record's kind, and `bytes` of SERVER_BUDGET_FLIGHT, which
 * become SERVER_BUDGET_MESHES, and retains the record. Budget and cache are borrowed and outlive
 * the surface. NULL without memory: object and bytes are the caller's still. The caller has one
 * reference. */
struct server_surface *server_surface_create(struct server_record *record, void *object,
                                             size_t bytes, struct server_budget *budget,
                                             struct server_cache *cache);

/* Takes over the record's attachment, malloc'ed, and as many bytes of SERVER_BUDGET_FLIGHT. Once,
 * before the surface is shared. */
void server_surface_attach(struct server_surface *surface, void *attachment);

struct server_surface *server_surface_retain(struct server_surface *surface);
void server_surface_release(struct server_surface *surface); /* NULL is harmless */

/* Ends the surface's fields and landmarks; to be called once, when it leaves the registry. */
void server_surface_retire(struct server_surface *surface);

#endif
