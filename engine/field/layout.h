/* Layout of a field in memory. Each edge has a chain of chunks (window/wedges.h). A chunk contains
 * final wedges. Chunks are stored in the order of propagation; a chain begins with its newest
 * chunk.
 *
 * Normalised unit; numbering of the mesh. */
#pragma once

#include "base/references.h"
#include "gd/field.h"
#include "mesh/local.h"
#include "wavefront/wavefront.h"

/* A seed that is not at a vertex, and a face that contains the seed. A seed on an edge has an entry
 * for each face of the edge. */
struct gd__face_seed {
    uint32_t face, seed;
};

struct gd_field {
    atomic_uint references;
    const struct gd_mesh *mesh;
    double reach;                        /* normalised unit; GD__FAR if complete */
    double *distance;                    /* per vertex */
    struct gd__predecessor *predecessor; /* per vertex */
    /* for each edge, its newest chunk, in GD__CHUNK_UNITs of `wedges`, or GD_NONE if there is
       none */
    uint32_t *newest;
    char *wedges; /* chunks */
    size_t wedge_bytes;
    struct gd__kept kept; /* memory of the wedges; empty for an image */
    struct gd__seed *seeds;
    uint32_t seed_count;
    bool has_segments;                /* true if some seeds are segments */
    struct gd__face_seed *face_seeds; /* sorted by face */
    uint32_t face_seed_count;
    size_t bytes;
    struct gd_field_statistics statistics;
    void (*release_image)(void *user);
    void *image_user;
    bool is_image; /* the arrays lie in an image: the field does not free them */
    /* If this field is a view with a smaller reach: the field that owns the arrays (a reference).
       Otherwise NULL. */
    const struct gd_field *shown;
};

/* Returns the number of the seed of a pseudo-source that is not a vertex. */
static inline uint32_t gd__field_seed_of(const struct gd_field *field, uint32_t source)
{
    return (source & ~GD__SOURCE_LINEAR) - field->mesh->vertex_count;
}

/* Returns the distance of a pseudo-source. */
static inline double gd__field_sigma(const struct gd_field *field, uint32_t source)
{
    uint32_t vertices = field->mesh->vertex_count;
    return source < vertices ? field->distance[source]
                             : field->seeds[gd__field_seed_of(field, source)].offset;
}

/* Returns window `i` of a chunk, in the frame of side 0, with its sigma. A gap has source GD_NONE
 * and no sigma. */
static inline struct gd__window gd__field_window(const struct gd_field *field,
                                                 const struct gd__chunk *chunk, uint32_t i,
                                                 double length)
{
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    struct gd__window w = gd__wedge_window(&wedges, i, length);
    if (w.source != GD_NONE && !gd__window_is_linear(&w))
        w.sigma = gd__field_sigma(field, w.source);
    return w;
}

/* Returns the chunk at an offset that is not GD_NONE. */
static inline const struct gd__chunk *gd__field_chunk(const struct gd_field *field, uint32_t at)
{
    return (const struct gd__chunk *)(field->wedges + (size_t)at * GD__CHUNK_UNIT);
}

/* field.c: a sink that moves the wavefront's wedges, distances and predecessors into the field. */
enum gd_status gd__field_take(void *field, struct gd__wavefront *front);

/* field.c: lets a field without arrays read those of the wavefront, which the workspace still owns.
 * Does not set the seeds. */
void gd__field_view(const struct gd__wavefront *front, double reach, struct gd_field *view);

/* field.c: runs the propagation and checks the result. The field must have its seeds. Sets build_ns
 * of the statistics. Errors: those of gd_field_build. */
GD_MUST_USE enum gd_status gd__field_propagate(struct gd_field *field,
                                               const struct gd__propagation *propagation,
                                               const struct gd_control *control);

/* field.c: creates a field that has no arrays, retains the mesh, and has one reference. Returns
 * NULL if memory is exhausted. */
struct gd_field *gd__field_create(const struct gd_mesh *mesh);

/* face_seeds.c: fills face_seeds and has_segments from the seeds, and sets the face of each
 * segment, except in an image, which is read-only. Errors: GD_NO_MEMORY, GD_INVALID_ARGUMENT (no
 * face contains a segment). O(n log n). */
GD_MUST_USE enum gd_status gd__field_index_seeds(struct gd_field *field);

/* face_seeds.c: copies the seeds of a request in the normalised unit, and indexes them as
 * gd__field_index_seeds does. Errors: GD_NO_MEMORY, GD_INVALID_ARGUMENT (an offset is negative or
 * not finite, or no face contains a segment). O(n log n). */
GD_MUST_USE enum gd_status gd__field_take_seeds(struct gd_field *field,
                                                const struct gd_field_request *request,
                                                struct gd_detail *detail);

/* field.c: returns the size of the arrays in bytes. */
size_t gd__field_bytes(const struct gd_field *field);

/* field.c: bounds of a maximum of the distance inside a face. `least` is the greatest distance of a
 * corner. `most` is an upper bound of all distances in the face, because each point is at most an
 * edge's length away from each corner. `most` may be less than `least`, for example if the field
 * does not reach a corner. */
struct gd__levels {
    double least, most;
};
struct gd__levels gd__field_face_levels(const struct gd_field *field, uint32_t face);

/* face_seeds.c: returns the range of face_seeds in a face. */
struct gd__face_seeds {
    const struct gd__face_seed *at, *end;
};
struct gd__face_seeds gd__field_seeds_in(const struct gd_field *field, uint32_t face);

/* The kind of a path's last leg. */
enum gd__leg_kind {
    GD__LEG_NONE, /* no path */
    /* straight from a vertex of the face, or of length zero if the point is a vertex */
    GD__LEG_VERTEX,
    GD__LEG_SEED,  /* straight from a seed in the face; perpendicular to a segment */
    GD__LEG_CLOSE, /* straight from a close seed in another face (close_seed.h) */
    GD__LEG_WEDGE  /* across `side` at `parameter` */
};

struct gd__leg {
    double distance;
    enum gd__leg_kind kind;
    uint32_t face; /* the face in which the leg ends */
    uint32_t from; /* the vertex of a GD__LEG_VERTEX, the seed of a GD__LEG_SEED or GD__LEG_CLOSE */
    /* For GD__LEG_WEDGE: `side` is a side of `face`. In its frame, (x, -y) with y >= 0 is the
     * source's position, or for a linear wedge the direction towards the source. */
    uint32_t side;
    double parameter, x, y;
    /* The source of the wedge. A leg that bends at the wedge's end bends at `parameter`, and its
       continuation leads to this source too. */
    uint32_t source;
};

/* The best path to a point in compact form. `from` is a vertex or a seed. For GD__LEG_WEDGE it is
 * the number of a wedge, in the order in which leg.c searches the wedges of the face's edges. */
struct gd__leg_key {
    double distance;
    double margin; /* more than 0 if the path is precise although it is short: see margin_of */
    enum gd__leg_kind kind;
    uint32_t face; /* the face in which the path ends */
    uint32_t from;
};

/* Finds the best path to a point over all faces that contain the point. If there is no path, the
 * result is GD__FAR and GD__LEG_NONE. The function writes `out` member by member. Do not copy the
 * whole struct right after the call: the copy would wait for these stores (failed store
 * forwarding). */
void gd__field_leg_key(const struct gd_field *field, const struct gd_point *point,
                       struct gd__leg_key *out);

/* nearest.c: returns the pseudo-source where the last leg to a reached vertex begins. GD_NONE means
 * that the predecessors of a damaged image are invalid. */
uint32_t gd__field_source_behind(const struct gd_field *field, uint32_t vertex);

/* Returns the last leg of the best path to a point. */
struct gd__leg gd__field_leg(const struct gd_field *field, const struct gd_point *point);

/* Returns the last leg to a point of an edge where the path to `vertex` bends. In faces as small as
 * the rounding error, the best path may lead back to `vertex`. The result is then a leg to the
 * nearer end of the edge. */
struct gd__leg gd__field_leg_onward(const struct gd_field *field, const struct gd_point *bend,
                                    uint32_t vertex);

/* Computes gd_field_distance and gd_field_path in one call. Without a path the distance is INFINITY
 * and *out is untouched. */
GD_MUST_USE enum gd_status gd__field_distance_and_path(const struct gd_field *field,
                                                       const struct gd_point *point,
                                                       double *distance, struct gd_path *out);
