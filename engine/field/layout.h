/* A field from the inside: final-stage wedges, a chain of chunks an edge (window/wedges.h), in the
 * order in which they were made.
 *
 * Inside unit and numbering of the mesh. */
#ifndef GD_FIELD_LAYOUT_H
#define GD_FIELD_LAYOUT_H

#include <stdatomic.h>

#include "gd/field.h"
#include "mesh/local.h"
#include "wavefront/wavefront.h"

/* A seed that is not at a vertex, by a face that contains it, a segment along an edge by both of
 * the edge's. */
struct gd__face_seed {
    uint32_t face, seed;
};

struct gd_field {
    atomic_uint references;
    const struct gd_mesh *mesh;
    double reach;                        /* inside unit; GD__FAR: complete */
    double *distance;                    /* per vertex */
    struct gd__predecessor *predecessor; /* per vertex */
    /* per edge: its newest chunk, in GD__CHUNK_UNITs of `wedges`; GD_NONE: none */
    uint32_t *newest;
    char *wedges; /* chunks */
    size_t wedge_bytes;
    struct gd__kept kept; /* their memory; empty for an image */
    struct gd__seed *seeds;
    uint32_t seed_count;
    bool has_segments;                /* among the seeds */
    struct gd__face_seed *face_seeds; /* sorted by face */
    uint32_t face_seed_count;
    size_t bytes;
    struct gd_field_statistics statistics;
    void (*release_image)(void *user);
    void *image_user;
    bool is_image; /* the arrays lie in an image and are not the field's to free */
    /* whose arrays these are, seen within a smaller reach; a reference. NULL: its own, or an
       image's */
    const struct gd_field *shown;
};

/* Number of the seed that a pseudo-source is, which is no vertex. */
static inline uint32_t gd__field_seed_of(const struct gd_field *field, uint32_t source)
{
    return (source & ~GD__SOURCE_LINEAR) - field->mesh->vertex_count;
}

/* Distance of a pseudo-source. */
static inline double gd__field_sigma(const struct gd_field *field, uint32_t source)
{
    uint32_t vertices = field->mesh->vertex_count;
    return source < vertices ? field->distance[source]
                             : field->seeds[gd__field_seed_of(field, source)].offset;
}

/* Window `i` of a chunk, in the frame of side 0, with its sigma; a gap has source GD_NONE and
 * none. */
static inline struct gd__window gd__field_window(const struct gd_field *field,
                                                 const struct gd__chunk *chunk, uint32_t i,
                                                 double length)
{
    struct gd__window w = gd__wedge_window(gd__chunk_wedges(chunk), chunk->count, i, length);
    if (w.source != GD_NONE && !gd__window_is_linear(&w))
        w.sigma = gd__field_sigma(field, w.source);
    return w;
}

/* The chunk at an offset that is not GD_NONE. */
static inline const struct gd__chunk *gd__field_chunk(const struct gd_field *field, uint32_t at)
{
    return (const struct gd__chunk *)(field->wedges + (size_t)at * GD__CHUNK_UNIT);
}

/* field.c: the sink that keeps all: the wavefront's wedges, distances and predecessors become the
 * field's. */
enum gd_status gd__field_take(void *field, struct gd__wavefront *front,
                              const struct gd_executor *executor);

/* field.c: runs the propagation into the field, whose seeds it has, and checks what came of it;
 * build_ns of the statistics is its time. Errors: those of gd_field_build. */
GD_MUST_USE enum gd_status gd__field_propagate(struct gd_field *field,
                                               const struct gd__propagation *propagation,
                                               const struct gd_control *control,
                                               const struct gd_executor *executor);

/* field.c: a field without arrays that retains the mesh and has one reference; NULL without
 * memory. */
struct gd_field *gd__field_create(const struct gd_mesh *mesh);

/* face_seeds.c: fills face_seeds and has_segments from the seeds, and tells each segment its face,
 * but for an image's, which is not written to. GD_NO_MEMORY; GD_INVALID_ARGUMENT: a segment that
 * lies in no face. O(n). */
GD_MUST_USE enum gd_status gd__field_index_seeds(struct gd_field *field);

/* face_seeds.c: copies the seeds of a request, in inside terms, and indexes them as
 * gd__field_index_seeds. GD_NO_MEMORY; GD_INVALID_ARGUMENT: an offset that is negative or not
 * finite, a segment that lies in no face. O(n). */
GD_MUST_USE enum gd_status gd__field_take_seeds(struct gd_field *field,
                                                const struct gd_field_request *request,
                                                struct gd_detail *detail);

/* field.c: what the arrays take. */
size_t gd__field_bytes(const struct gd_field *field);

/* face_seeds.c: the first of face_seeds that lies in `face`; those after it with the same face
 * follow. */
const struct gd__face_seed *gd__field_seeds_in(const struct gd_field *field, uint32_t face);

/* How the shortest path to a point ends: its last leg. */
enum gd__leg_kind {
    GD__LEG_NONE,   /* no path */
    GD__LEG_VERTEX, /* straight from a vertex of the face (or it is that vertex) */
    GD__LEG_SEED,   /* straight from a seed in the face, at right angles from a segment */
    GD__LEG_CLOSE,  /* straight from a seed close by in another face (close.h) */
    GD__LEG_WEDGE   /* across `side` at `parameter` */
};

struct gd__leg {
    double distance;
    enum gd__leg_kind kind;
    uint32_t face; /* in which the leg ends */
    uint32_t from; /* GD__LEG_VERTEX: the vertex; GD__LEG_SEED, GD__LEG_CLOSE: the seed */
    /* GD__LEG_WEDGE: side of `face`, and the wedge's source in its frame at (x, -y), y >= 0, or, of
       a linear one, the direction towards it */
    uint32_t side;
    double parameter, x, y;
    /* the wedge's. A leg clamped to the wedge's end bends at `parameter` and goes on to the same
       source */
    uint32_t source;
};

/* The best way to a point in as few words as tell it from all others. `from` names a vertex, a seed
 * or, for GD__LEG_WEDGE, a wedge of the face's edges by its place in the search (leg.c). */
struct gd__way {
    double distance;
    enum gd__leg_kind kind;
    uint32_t face; /* in which it ends */
    uint32_t from;
};

/* The best way to a point over all faces that contain it; GD__FAR and GD__LEG_NONE if there is
 * none. `out` is written field by field and must not be copied at once: that would wait for the
 * stores. */
void gd__field_way(const struct gd_field *field, const struct gd_point *point, struct gd__way *out);

/* nearest.c: the pseudo-source in which the last leg of the way to a vertex begins, which a path
 * reaches; GD_NONE where the predecessors of a damaged image lead nowhere. */
uint32_t gd__field_source_behind(const struct gd_field *field, uint32_t vertex);

/* The leg by which the best way ends. */
struct gd__leg gd__field_leg(const struct gd_field *field, const struct gd_point *point);

/* The same at a place of an edge where the path to a vertex bends. In faces as small as rounding
 * its best way leads back to that vertex: it goes on by the nearer end of the edge then. */
struct gd__leg gd__field_leg_onward(const struct gd_field *field, const struct gd_point *bend,
                                    uint32_t vertex);

/* gd_field_distance and gd_field_path at once. Where no path leads the distance is INFINITY, and
 * *out is untouched. */
GD_MUST_USE enum gd_status gd__field_distance_and_path(const struct gd_field *field,
                                                       const struct gd_point *point,
                                                       double *distance, struct gd_path *out);

#endif
