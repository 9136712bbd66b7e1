/* Surface: an object in memory (for instance a mesh) with its record, attachment, cached fields and
 * landmarks. Also builds surfaces from files.
 *
 * A surface is immutable except for its reference count, its mesh cache and its slots. Mesh cache
 * and slots refer to the mesh until the surface is retired. */
#ifndef SERVER_SURFACES_SURFACE_H
#define SERVER_SURFACES_SURFACE_H

#include "gd/mesh.h"
#include "server/fields/cache.h"
#include "server/fields/lru.h"
#include "server/store/record.h"

struct server_background;

#define SERVER_BACKGROUND_DONE 1000000 /* the progress of a build that has ended */

struct server_background_slot {                /* see background.h; all zero but `surface`: empty */
    struct server_surface *surface;            /* the surface that contains the slot */
    _Atomic(struct server_background *) owner; /* NULL: never used by a request */
    atomic_bool is_closed;
    atomic_uint progress; /* progress of the build, up to SERVER_BACKGROUND_DONE */
    /* under the owner's lock: */
    struct server_lru_item *item;               /* NULL: empty */
    bool is_coming;                             /* queued, or being built */
    LIST_ENTRY(server_background_slot) waiting; /* until the build begins */
};

/* Empties the slot permanently. May be called again. */
void server_background_slot_close(struct server_background_slot *slot);

struct server_landmark_slot { /* see landmarks.h */
    struct server_background_slot base;
    /* under the owner's lock: */
    uint64_t cost_ns;       /* cost of the last build */
    uint64_t not_before_ns; /* the earliest begin of the next one */
};

struct server_preview_slot { /* see previews.h */
    struct server_background_slot base;
    /* under the owner's lock: */
    uint32_t wanted;        /* faces of the preview that is coming */
    enum gd_status failure; /* failure of the last build; cleared when a request gets it */
};

struct server_surface {
    atomic_uint references;
    struct server_record *record;
    union { /* object of record->kind */
        void *object;
        struct gd_mesh *mesh;
    };
    void *attachment; /* record->attachment_size bytes, owned; NULL: there is none */
    /* bytes of object and attachment, in SERVER_BUDGET_MESHES until the last release */
    size_t bytes;
    struct server_budget *budget;
    struct server_mesh_cache *fields;
    struct server_landmark_slot landmarks;
    struct server_preview_slot preview;
};

/* Takes over the object, which has the record's kind, and `bytes` of SERVER_BUDGET_FLIGHT; retains
 * the record. NULL: out of memory; then the caller still owns object and bytes. */
struct server_surface *server_surface_create(struct server_record *record, void *object,
                                             size_t bytes, struct server_budget *budget,
                                             struct server_cache *cache);

/* Takes over the record's attachment, malloc'ed, and its bytes of SERVER_BUDGET_FLIGHT. Call this
 * function before the surface is shared. */
void server_surface_attach(struct server_surface *surface, void *attachment);

struct server_surface *server_surface_retain(struct server_surface *surface);
void server_surface_release(struct server_surface *surface); /* NULL is allowed */

/* Retains a surface whose references may have ended; false: it is being freed. Call this function
 * before server_background_slot_close returns. */
bool server_surface_retain_alive(struct server_surface *surface);

/* Drops the surface's fields and landmarks permanently, when it leaves the registry. */
void server_surface_retire(struct server_surface *surface);

struct server_builder { /* all borrowed */
    struct server_budget *budget;
    struct server_cache *cache;
    uint32_t max_faces;
    struct gd_control control; /* ends the build early and receives progress; without a budget */
    struct server_record *record;
    const void *bytes; /* the record->size bytes of its file */
    struct proto_problem *problem;
};

/* Builds the surface of a record, without its attachment. On failure returns a status and sets the
 * problem. GD_BUDGET: the budget has too little memory. */
GD_MUST_USE enum gd_status server_build_surface(const struct server_builder *builder,
                                                struct server_surface **out);

/* For kinds: takes bytes of SERVER_BUDGET_FLIGHT. GD_BUDGET with the problem. */
GD_MUST_USE enum gd_status server_build_take(const struct server_builder *builder, size_t bytes);

/* For kinds: sets the problem of an engine status, which it returns. `detail` may be NULL. */
enum gd_status server_build_refuse(const struct server_builder *builder, enum gd_status status,
                                   const struct gd_detail *detail);

#endif
