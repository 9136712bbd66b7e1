/* Walker: local subdivision, and the memory that it needs. One owner, one thread.
 *
 * DESIGN. The limit surface over a face depends on the face's one-ring only: the faces that share a
 * corner with it. The one-ring of a child of the face lies in the refinement of that one-ring. So a
 * neighbourhood is a net whose face 0 is the face in question, its corners points 0, 1, ...; it is
 * refined by the same gd__net_refine as a whole mesh, and the neighbourhood of a child is cut out
 * of the result. That goes on until all corners of the face are regular, when the surface over it
 * is one polynomial, or until its vertex is reached. Each cut moves the coordinates' origin to the
 * face's first corner; points shrink with the face, and what rounding leaves shrinks with them:
 * derivatives stay exact however deep.
 *
 * Stages alternate or are stacked: stage i holds a neighbourhood and its refinement. */
#ifndef GD_SUBDIV_WALKER_H
#define GD_SUBDIV_WALKER_H

#include "subdiv/surface.h"

/* So many halvings take a ring of any valence (they shrink by 0.41 to 0.66) below rounding; nearer
 * than that a place is the vertex. */
enum { GD__DEPTH_MOST = 85 };

struct gd__stage {
    struct gd__net ring, refined;
};

/* A polynomial piece of a base face. */
struct gd__cell {
    uint32_t face;          /* GD_NONE: none */
    struct gd__chart frame; /* from the piece's coordinates to the base face's */
    double slack;           /* what rounding of the base face's coordinates makes of the piece's */
    struct gd_vec3 origin;  /* of the patch's points */
    struct gd__patch patch;
};

struct gd__walker {
    const struct gd_subdivision *surface; /* borrowed */
    struct gd__stage *stages;
    uint32_t stage_count;
    struct gd__fan fan;
    uint32_t stamp;
    /* where a cut put a face or point, if stamped */
    uint32_t *face_stamp, *face_at, *point_stamp, *point_at;
    uint32_t *cut_faces;   /* of the net that was cut from */
    struct gd__cell piece; /* the last one that was looked for */
};

/* `stages` >= 2. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__walker_create(struct gd__walker *walker,
                                             const struct gd_subdivision *surface, uint32_t stages,
                                             const struct gd_control *control);
void gd__walker_free(struct gd__walker *walker);

/* Cuts the neighbourhood of a face of `from` into `out`, relative to its first corner, which is
 * added to `origin`. */
void gd__cut(struct gd__walker *walker, const struct gd__net *from, uint32_t face,
             struct gd__net *out, struct gd_vec3 *origin);

/* Refines the neighbourhood of stage `from` and cuts a child of its face 0 into stage `to`. */
void gd__descend(struct gd__walker *walker, uint32_t from, uint32_t child, uint32_t to,
                 struct gd_vec3 *origin);

/* Whether face 0 of a neighbourhood is one polynomial: all corners are inside without sharp edges
 * and of regular valence, or on a crease that is infinitely sharp and has as many faces on this
 * side as a straight one, or (Catmull-Clark) corners of one face. */
bool gd__ring_is_regular(const struct gd__net *ring, struct gd__fan *fan);

/* What the surface does at a vertex, seen from a face: directions of the two edges of the face, of
 * unit length, and the normal. NAN where there is none. */
struct gd__vertex {
    struct gd_vec3 position, normal, s, t;
};

/* At corner `corner` of face 0 of stage `at`, whose origin is `origin`; stages `free` and `free` +
 * 1 are used. */
void gd__vertex_limit(struct gd__walker *walker, uint32_t at, uint32_t corner, uint32_t free,
                      struct gd_vec3 origin, struct gd__vertex *out);

/* The piece at a spot, into walker->piece; where pieces meet, the one that (ds,dt) leads into.
 * False: the spot is a vertex that is no piece's, corner
 * `*corner` of the base face. */
bool gd__cell_at(struct gd__walker *walker, const struct gd__spot *spot, double ds, double dt,
                 uint32_t *corner);

/* The surface at a spot of walker->piece, in the coordinates of its base face. */
struct gd__jet gd__cell_jet(const struct gd__walker *walker, double s, double t);

/* The surface at a corner of a base face. */
void gd__corner_limit(struct gd__walker *walker, uint32_t face, uint32_t corner,
                      struct gd__vertex *out);

#endif
