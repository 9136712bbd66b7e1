/* Surface: an object in memory (for instance a mesh) with its record, attachment, cached fields and
 * landmarks. Also builds surfaces from files.
 *
 * A surface is immutable except for its reference count, its mesh cache and its slots. Mesh cache
 * and slots refer to the mesh until the surface is retired. */
#pragma once

#include "gd/mesh.h"
#include "server/fields/cache.h"
#include "server/fields/lru.h"
#include "server/store/record.h"
#include "server/work/workers.h"

struct server_background;

#define SERVER_BACKGROUND_DONE 1000000 /* value of `progress` after a build has ended */

/* See background.h. An empty slot is all zero, except for `surface`. */
struct server_background_slot {
    struct server_surface *surface;            /* the surface that contains the slot */
    _Atomic(struct server_background *) owner; /* NULL until a request uses the slot */
    atomic_bool is_closed;
    atomic_uint progress; /* progress of the build, up to SERVER_BACKGROUND_DONE */
    /* guarded by the owner's lock: */
    struct server_lru_item *item;               /* NULL if empty */
    bool is_coming;                             /* true if the result is queued or being computed */
    LIST_ENTRY(server_background_slot) waiting; /* link in the list of waiting slots */
};

/* Empties the slot permanently. May be called again. */
void server_background_slot_close(struct server_background_slot *slot);

struct server_landmark_slot { /* see landmarks.h */
    struct server_background_slot base;
    /* guarded by the owner's lock: */
    uint64_t cost_ns;       /* cost of the last build */
    uint64_t not_before_ns; /* the earliest time of the next build */
};

struct server_preview_slot { /* see previews.h */
    struct server_background_slot base;
    /* guarded by the owner's lock: */
    uint32_t wanted;        /* number of faces of the queued preview */
    enum gd_status failure; /* failure of the last build; cleared when a request gets it */
};

struct server_surface {
    atomic_uint references;
    struct server_record *record;
    union { /* the object, of the kind record->kind */
        void *object;
        struct gd_mesh *mesh;
    };
    void *attachment; /* record->attachment_size bytes, owned; may be NULL */
    /* bytes of object and attachment, counted in SERVER_BUDGET_MESHES until the last release */
    size_t bytes;
    struct server_budget *budget;
    struct server_mesh_cache *fields;
    struct server_landmark_slot landmarks;
    struct server_preview_slot preview;
};

/* Creates a surface. Takes over the object, which must have the record's kind, and `bytes` of
 * SERVER_BUDGET_FLIGHT. Retains the record. Returns NULL if out of memory; then the caller still
 * owns object and bytes. */
struct server_surface *server_surface_create(struct server_record *record, void *object,
                                             size_t bytes, struct server_budget *budget,
                                             struct server_cache *cache);

/* Takes over the record's attachment, malloc'ed, and its bytes of SERVER_BUDGET_FLIGHT. Call this
 * function before the surface is shared. */
void server_surface_attach(struct server_surface *surface, void *attachment);

struct server_surface *server_surface_retain(struct server_surface *surface);
void server_surface_release(struct server_surface *surface); /* NULL is allowed */

/* Retains a surface that may have lost its last reference. Returns false if the surface is being
 * freed. Call this function before server_background_slot_close returns. */
bool server_surface_retain_alive(struct server_surface *surface);

/* Drops the surface's fields and landmarks permanently, when it leaves the registry. */
void server_surface_retire(struct server_surface *surface);

/* A record, and its surface while that is in memory; a reference to each. */
struct server_listed {
    struct server_record *record;
    struct server_surface *surface; /* NULL if not in memory */
};
void server_listed_release(struct server_listed *listed); /* accepts all zero */

struct server_builder { /* all borrowed */
    struct server_budget *budget;
    struct server_cache *cache;
    uint32_t max_faces;
    /* ends the build early and receives progress; its budget and its executor are unset */
    struct gd_control control;
    struct server_workers *workers; /* help to build a large surface */
    struct server_record *record;
    const void *bytes; /* the record->size bytes of its file */
    /* the mesh of the file, if it is built already; otherwise NULL */
    const struct gd_mesh *mesh;
    /* NULL, or the owner of `bytes`, which a build frees as soon as it has read them */
    void **file;
    struct proto_problem *problem;
};

/* Builds the surface of a record, without its attachment. On failure returns a status and sets the
 * problem; the status is GD_BUDGET if the budget has too little memory. */
GD_MUST_USE enum gd_status server_build_surface(const struct server_builder *builder,
                                                struct server_surface **out);

/* Called by kinds. Takes bytes of SERVER_BUDGET_FLIGHT. On failure, returns GD_BUDGET and sets the
 * problem. */
GD_MUST_USE enum gd_status server_build_take(const struct server_builder *builder, size_t bytes);

/* Called by kinds. Sets the problem of an engine status, and returns this status. `detail` may be
 * NULL. */
enum gd_status server_build_refuse(const struct server_builder *builder, enum gd_status status,
                                   const struct gd_detail *detail);
