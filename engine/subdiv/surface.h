/* Surface: what a subdivision surface holds, for the files of this room.
 *
 * Base faces are those from which everything starts: all quads (Loop: triangles). They are the
 * control mesh's own faces or, where one of those is no quad, all of its faces' children after one
 * refinement, so that base face h is the child at side h of the control mesh. */
#ifndef GD_SUBDIV_SURFACE_H
#define GD_SUBDIV_SURFACE_H

#include <stdatomic.h>

#include "gd/limit.h"
#include "subdiv/scheme.h"

struct gd__box {
    struct gd_vec3 low, high;
};

struct gd_subdivision {
    atomic_uint references;
    enum gd_scheme scheme;
    const struct gd__scheme *rules;
    struct gd__net base;
    /* per control face: its first base face, one more at the end; NULL: base faces are control
       faces */
    uint32_t *split_first;
    uint32_t control_faces;
    uint32_t largest_valence; /* of base vertices, at least the regular one */
    uint32_t base_edges;      /* base.edge numbers the edges; that of a lower side is its owner */
    struct gd_subdivision_summary summary;
    struct gd_valence *valences;
    /* per base face: of its one-ring, whose convex hull the surface over the face keeps to */
    struct gd__box *boxes;
    double size; /* largest extent of the control points */
};

/* Affine map from a face's own coordinates to those of one that it is a part of: origin + s * s[] +
 * t * t[]. */
struct gd__chart {
    double origin[2], s[2], t[2];
};

#define GD__CHART_WHOLE ((struct gd__chart){{0, 0}, {1, 0}, {0, 1}})

/* The frame of child `child`, in the coordinates that `frame` maps to. */
struct gd__chart gd__chart_child(const struct gd__chart *frame, const struct gd__child *child);
void gd__chart_out(const struct gd__chart *frame, double s, double t, double out[2]);
void gd__chart_in(const struct gd__chart *frame, double u, double v, double out[2]);

/* The jet in the coordinates that the frame maps to. */
struct gd__jet gd__chart_jet(const struct gd__chart *frame, const struct gd__jet *jet);

/* A place on a base face. */
struct gd__spot {
    uint32_t face;
    double s, t;
};

/* Places that are known to be in range, and base faces' spots. `frame` of a base face maps to the
 * coordinates of its control face. */
struct gd__spot gd__spot_of(const struct gd_subdivision *surface,
                            const struct gd_limit_point *place);
struct gd__chart gd__base_frame(const struct gd_subdivision *surface, uint32_t base, uint32_t *face,
                                uint32_t *corner);
struct gd_limit_point gd__place_of(const struct gd_subdivision *surface,
                                   const struct gd__spot *spot);

/* GD_OUT_OF_RANGE, GD_INVALID_ARGUMENT; moves u and v that are off by rounding into the face. */
GD_MUST_USE enum gd_status gd__place_check(const struct gd_subdivision *surface,
                                           struct gd_limit_point *place, struct gd_detail *detail);

#endif
