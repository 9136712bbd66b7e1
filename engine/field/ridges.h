/* Ridges: a cut locus under construction, as a graph of nodes and parts.
 *
 * DESIGN
 * - A part is a piece of the branch of two sources of one face (sources.h). On this piece, both
 *   sources see the branch, no third source is nearer, and the paths arrive from different
 *   directions.
 * - Two sources are *related* if one is on the paths of the other: two wedges of one source, a
 *   corner and the source behind it, a segment and its end. Then their distances differ, or agree
 *   together with their directions. So they have no ridge. Where they agree, one of them takes
 *   precedence, so that no part is found twice.
 * - Members name the parts and have no influence on them. So there is no nudge as in a Voronoi
 *   diagram (voronoi_parts.h).
 * - A ridge along an edge may be found in one of the edge's faces or in both, because the field
 *   stores equally near windows from one or from both sides. Such parts may lie beside their face
 *   by the rounding of a ridge. They are joined to disjoint intervals of the edge.
 * - The ends of parts are matched by place: at a vertex, on an edge, in a face. The number of parts
 *   that end at a place is arbitrary, so ties need no rule.
 * - Normalised unit. */
#ifndef GD_FIELD_RIDGES_H
#define GD_FIELD_RIDGES_H

#include "field/voronoi_parts.h"
#include "gd/cut_locus.h"

/* An end of a part. */
struct gd__ridge_end {
    enum gd_point_kind kind;
    uint32_t element;    /* vertex, edge or face */
    struct gd__local at; /* on an edge: x is measured from the origin of its side 0, and y is 0 */
    double near;         /* ends this close are at one place */
    struct gd_point point;
    uint32_t part, end; /* set by gd__ridges_add */
};

struct gd__ridge {
    struct gd__bisector_part part;
    double angle; /* greatest angle between the directions of arrival */
    struct gd__ridge_end end[2];
};

/* A part along an edge; t is measured from the origin of the edge's side 0. */
struct gd__along {
    uint32_t edge, face, member[2];
    double from, to, angle, near;
};

/* An all-zero struct is empty. */
struct gd__ridges {
    struct gd__diagram diagram;
    struct gd__voronoi_scratch scratch;
    double *angle; /* for each part */
    struct gd__ridge_end *end;
    struct gd__along *along;
    uint32_t first_along; /* this part and all later parts run along edges */
    uint32_t angle_count, angle_capacity, end_count, end_capacity, along_count, along_capacity;
};

/* ridge_face.c: appends the parts of a face. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__ridges_of_face(struct gd__ridges *ridges, uint32_t face);

/* ridge_graph.c: append a part with its ends, or a part along an edge. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__ridges_add(struct gd__ridges *ridges, const struct gd__ridge *ridge);
GD_MUST_USE enum gd_status gd__ridges_add_along(struct gd__ridges *ridges, uint32_t edge,
                                                const struct gd__ridge *ridge);

/* Assigns nodes to all ends, and removes branches whose angles are below `min_angle`. Error:
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__ridges_join(struct gd__ridges *ridges, double min_angle);

#endif
