/* Surface: an object of some kind in memory (a mesh for instance), with its record, attachment,
 * cached fields and landmarks; and how it is built from a file.
 *
 * Immutable but for its count, its mesh cache and its slot. Cached fields and landmarks hold the
 * mesh: retiring the surface releases both. */
#ifndef SERVER_SURFACES_SURFACE_H
#define SERVER_SURFACES_SURFACE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "gd/control.h"
#include "gd/mesh.h"
#include "server/fields/cache.h"
#include "server/store/record.h"

struct server_job;
struct server_landmarks;
struct server_landmark_set;

struct server_landmark_slot {                 /* see landmarks.h; all zero is empty */
    _Atomic(struct server_landmarks *) owner; /* NULL: no search has asked */
    atomic_bool is_closed;
    /* under the owner's lock: */
    struct server_landmark_set *set;          /* NULL: empty */
    TAILQ_ENTRY(server_landmark_slot) by_use; /* while there is a set */
    struct server_job *waiting;               /* the job that builds the set, until it begins */
    bool is_coming;                           /* a job builds or reads a set */
    uint64_t cost_ns;                         /* of the last job */
    uint64_t not_before_ns;                   /* the earliest begin of the next one */
};

/* Empties the slot for good. May be called again. */
void server_landmark_slot_close(struct server_landmark_slot *slot);

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

/* Takes over the object, which is of the record's kind, and `bytes` of SERVER_BUDGET_FLIGHT, and
 * retains the record. NULL without memory: object and bytes stay the caller's. */
struct server_surface *server_surface_create(struct server_record *record, void *object,
                                             size_t bytes, struct server_budget *budget,
                                             struct server_cache *cache);

/* Takes over the record's attachment, malloc'ed, and as many bytes of SERVER_BUDGET_FLIGHT. Once,
 * before the surface is shared. */
void server_surface_attach(struct server_surface *surface, void *attachment);

struct server_surface *server_surface_retain(struct server_surface *surface);
void server_surface_release(struct server_surface *surface); /* NULL is harmless */

/* Drops the surface's fields and landmarks for good, when it leaves the registry. */
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

/* Builds the surface of a record, without its attachment. On failure a status and a problem;
 * GD_BUDGET: over the budget. */
GD_MUST_USE enum gd_status server_build_surface(const struct server_builder *builder,
                                                struct server_surface **out);

/* For kinds: takes bytes of SERVER_BUDGET_FLIGHT. GD_BUDGET with the problem. */
GD_MUST_USE enum gd_status server_build_take(const struct server_builder *builder, size_t bytes);

/* For kinds: sets the problem of a status of the engine; `detail` may be NULL. The status. */
enum gd_status server_build_refuse(const struct server_builder *builder, enum gd_status status,
                                   const struct gd_detail *detail);

#endif
