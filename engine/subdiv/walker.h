/* Walker: local subdivision, and its memory. A walker belongs to one thread.
 *
 * DESIGN. The limit surface over a face depends only on the face's one-ring: the faces that share a
 * corner with it. The one-ring of a child face is a part of the refined one-ring of its parent. The
 * neighbourhood of a face is a net whose face 0 is that face, with corners 0, 1, ... It is refined
 * by gd__net_refine like a whole mesh, and the neighbourhood of a child is extracted from the
 * result. The descent ends when all corners of the face are regular, so that the surface over the
 * face is one polynomial, or when the place counts as a vertex. Each extraction moves the origin of
 * coordinates to the face's first corner, so that rounding errors shrink with the face, and
 * derivatives stay accurate at any depth.
 *
 * Each stage holds a neighbourhood and its refinement. A descent alternates between two stages; a
 * recursion over children uses one stage for each level. */
#pragma once

#include "subdiv/surface.h"

/* Largest number of halvings. After this many halvings, a ring of any valence is smaller than
 * rounding errors, because each step multiplies its size by 0.41 to 0.66. A place that is still
 * closer to the vertex counts as the vertex. */
enum { GD__DEPTH_MOST = 85 };

struct gd__stage {
    struct gd__net ring, refined;
};

/* A polynomial piece of a base face. */
struct gd__cell {
    uint32_t face;          /* GD_NONE if there is no piece */
    struct gd__chart frame; /* maps the piece's coordinates to the base face's */
    /* rounding error of the base face's coordinates, measured in the piece's coordinates */
    double slack;
    struct gd_vec3 origin; /* added to positions on the patch */
    struct gd__patch patch;
};

struct gd__walker {
    const struct gd_subdivision *surface; /* borrowed */
    struct gd__stage *stages;
    struct gd__fan fan;
    uint32_t stamp;
    /* for each face or point, its number in the extracted net; valid if its stamp is the current
       one */
    uint32_t *face_stamp, *face_at, *point_stamp, *point_at;
    uint32_t *cut_faces;   /* the extracted faces, by their numbers in the source net */
    struct gd__cell piece; /* the piece of the last query */
    struct gd__arena arena;
};

/* Creates a walker with `stages` >= 2. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__walker_create(struct gd__walker *walker,
                                             const struct gd_subdivision *surface, uint32_t stages,
                                             const struct gd_control *control);
void gd__walker_free(struct gd__walker *walker);

/* Extracts the neighbourhood of a face of `from` into `out`, relative to the face's first corner,
 * and adds that corner to *origin. */
void gd__neighbourhood_extract(struct gd__walker *walker, const struct gd__net *from, uint32_t face,
                               struct gd__net *out, struct gd_vec3 *origin);

/* Refines the neighbourhood in stage `from`, and extracts the neighbourhood of a child of its face
 * 0 into stage `to`. */
void gd__descend(struct gd__walker *walker, uint32_t from, uint32_t child, uint32_t to,
                 struct gd_vec3 *origin);

/* Returns true if the surface over face 0 is one polynomial. Each corner must be one of these: an
 * interior vertex of regular valence without sharp edges; a vertex on an infinitely sharp crease
 * with the regular number of faces on this side; or, with Catmull-Clark, a sharp corner with only
 * one face. */
bool gd__ring_is_regular(const struct gd__net *ring, struct gd__fan *fan);

/* The surface at a vertex, as the corner of one face: the position, the normal, and the unit
 * directions s and t of the face's two edges. NAN means that the vector does not exist. */
struct gd__vertex {
    struct gd_vec3 position, normal, s, t;
};

/* Computes the limit at corner `corner` of face 0 of stage `at`, whose coordinates are relative to
 * `origin`. Overwrites stages `free` and `free` + 1. */
void gd__vertex_limit(struct gd__walker *walker, uint32_t at, uint32_t corner, uint32_t free,
                      struct gd_vec3 origin, struct gd__vertex *out);

/* Finds the piece at a place and stores it in walker->piece. Where pieces meet, selects the piece
 * into which (ds,dt) points. At a vertex that no piece contains, returns false and sets *corner to
 * the vertex' corner in the base face. */
bool gd__cell_at(struct gd__walker *walker, const struct gd__face_place *local, double ds,
                 double dt, uint32_t *corner);

/* Evaluates the surface at a place of walker->piece; place and derivatives are in the coordinates
 * of the piece's base face. */
struct gd__jet gd__cell_jet(const struct gd__walker *walker, double s, double t);

/* Computes the surface at a corner of a base face. */
void gd__corner_limit(struct gd__walker *walker, uint32_t face, uint32_t corner,
                      struct gd__vertex *out);
