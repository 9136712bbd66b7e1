/* Surface: the members of a subdivision surface, for the files of this folder.
 *
 * All base faces are quads (Loop: triangles). If all faces of the control mesh are quads, they are
 * the base faces. Otherwise the control mesh is refined once, and the base faces are the children:
 * base face h is the child at side h of the control mesh. */
#pragma once

#include "base/references.h"
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
    struct gd__net control; /* the control mesh if the base faces are not its faces; else empty */
    /* for each control face, its first base face, and one more entry at the end; NULL if the
       control faces are the base faces */
    uint32_t *split_first;
    uint32_t control_faces;
    uint32_t largest_valence; /* largest valence of base vertices, at least the regular one */
    /* number of edges; base.edge has their numbers; of the two sides of an edge, the one with the
       lower number owns the edge */
    uint32_t base_edges;
    struct gd_subdivision_summary summary;
    struct gd_valence *valences;
    /* for each base face, the bounding box of its one-ring; it contains the surface over the
       face */
    struct gd__box *boxes;
    double size; /* largest extent of the control points */
    struct gd__arena arena;
};

/* Return the number of cells along a side of a base face at a level, and the number of triangles of
 * a base face with that many cells. */
static inline uint32_t gd__level_cells(const struct gd_subdivision *surface, uint32_t level)
{
    return 1u << (level - (surface->split_first && level > 0));
}

static inline uint64_t gd__face_triangles(const struct gd_subdivision *surface, uint64_t cells)
{
    return (surface->rules->arity == 4 ? 2 : 1) * cells * cells;
}

/* An affine map from a face's own coordinates to the coordinates of a face that contains it: origin
 * + s * s[] + t * t[]. */
struct gd__chart {
    double origin[2], s[2], t[2];
};

#define GD__CHART_WHOLE ((struct gd__chart){{0, 0}, {1, 0}, {0, 1}})

/* gd__chart_child returns the chart of a child of a face whose chart is `frame`; both charts map to
 * the same coordinates. gd__chart_out maps from a face's own coordinates to the coordinates of the
 * containing face. gd__chart_in is the inverse. */
struct gd__chart gd__chart_child(const struct gd__chart *frame, const struct gd__child *child);
void gd__chart_out(const struct gd__chart *frame, double s, double t, double out[2]);
void gd__chart_in(const struct gd__chart *frame, double u, double v, double out[2]);

/* Transforms a jet from a face's own coordinates to those of the containing face. */
struct gd__jet gd__chart_jet(const struct gd__chart *frame, const struct gd__jet *jet);

/* A place on a base face. */
struct gd__face_place {
    uint32_t face;
    double s, t;
};

/* Convert between valid places and places on base faces. gd__base_frame returns the chart of a base
 * face in its control face, and the number of this control face and of the corner. */
struct gd__face_place gd__face_place_of(const struct gd_subdivision *surface,
                                        const struct gd_limit_point *place);
struct gd__chart gd__base_frame(const struct gd_subdivision *surface, uint32_t base, uint32_t *face,
                                uint32_t *corner);
struct gd_limit_point gd__place_of(const struct gd_subdivision *surface,
                                   const struct gd__face_place *local);

/* Validates a place, and clamps u and v to the face if they are outside only by rounding. Errors:
 * GD_OUT_OF_RANGE, GD_INVALID_ARGUMENT. */
GD_MUST_USE enum gd_status gd__place_check(const struct gd_subdivision *surface,
                                           struct gd_limit_point *place, struct gd_detail *detail);
