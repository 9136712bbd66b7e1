/* Ridges: a cut locus under construction, as a graph of nodes and parts.
 *
 * DESIGN
 * - A part is a piece of the branch (voronoi_branch.h) of two sources of one face (sources.h). On
 *   this piece, both sources see the branch, no third source is nearer, and the paths arrive from
 *   different directions.
 * - Two sources are *related* if one lies on the paths from the other. Examples: a corner and a
 *   source behind it; a segment and its end; a source that is seen through two wedges, which counts
 *   twice. Related sources have no ridge: where they give equal distances, the directions are equal
 *   too. At such points one of the two sources takes precedence, so that no part is found twice.
 * - Parts are labelled with the members of their sources. Members have no influence on the
 *   positions of parts. So there is no nudge as in a Voronoi diagram (voronoi_parts.h).
 * - A ridge along an edge may be found in one of the edge's faces or in both, because the field
 *   stores equally near windows from one or from both sides. Such parts may lie slightly outside
 *   their face, because ridges are rounded. They are joined to disjoint intervals of the edge.
 * - The ends of parts are matched by position: at a vertex, on an edge, in a face. The number of
 *   parts that end at a position is arbitrary, so ties need no rule. The faces are processed in the
 *   order of their numbers. Ends on an edge wait until both faces of the edge are done. If there
 *   are parts along the edge, the ends wait until all faces are done.
 * - Most parts are straight up to the tolerance and store no arc. If the sources of such a part are
 *   needed later, they are gathered again.
 * - Normalised unit. */
#pragma once

#include "base/pace.h"
#include "field/voronoi_parts.h"
#include "gd/cut_locus.h"

/* An end of a part. */
struct gd__ridge_end {
    enum gd_point_kind kind;
    uint32_t element;    /* vertex, edge or face */
    struct gd__local at; /* on an edge: x is measured from the origin of its side 0, and y is 0 */
    double near;         /* ends at most this far apart are at one position */
    struct gd_point point;
    uint32_t part, end; /* set by gd__ridges_add */
};

/* An end on an edge that is not matched yet; t is measured from the origin of the edge's side 0. */
struct gd__waiting_end {
    double t, near;
    uint32_t part, end;
    uint32_t next; /* the next one on the edge, or in the list of unused entries */
};

/* The data that a part has in addition to gd__bisector_part. */
struct gd__ridge_pair {
    double angle; /* greatest angle between the directions of arrival */
    /* numbers of its sources in the face; GD_NONE for a part along an edge, or for a bridge over a
       gap */
    uint32_t source[2];
};

struct gd__ridge {
    struct gd__bisector_part part;
    struct gd__ridge_pair pair;
    struct gd__ridge_end end[2];
};

/* A part along an edge; t is measured from the origin of the edge's side 0. */
struct gd__along {
    uint32_t edge, face, member[2];
    double from, to, angle, near;
};

/* An all-zero struct can be closed. */
struct gd__ridges {
    struct gd__diagram diagram;
    struct gd__voronoi_scratch scratch;
    double tolerance; /* tolerance of the lines */
    double min_angle;
    struct gd__pace pace;
    struct gd__ridge_pair *pair; /* for each part */
    uint32_t *vertex_node;       /* for each vertex; GD_NONE if no part ends there */
    uint32_t *first_waiting;     /* for each edge; GD_NONE if no end waits */
    bool *has_along;             /* for each edge, true if parts run along it */
    struct gd__waiting_end *waiting;
    struct gd__ridge_end *here; /* ends in the current face or on the current edge */
    uint64_t *rivals;           /* scratch of a face: a row of bits for each source */
    struct gd__along *along;
    uint32_t unused;      /* first unused entry of `waiting`, or GD_NONE */
    uint32_t first_along; /* this part and all later parts run along edges */
    uint32_t pair_capacity, waiting_count, waiting_capacity, here_count, here_capacity, along_count,
        along_capacity, rivals_capacity;
};

/* ridge_face.c: appends the parts of a face. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__ridges_of_face(struct gd__ridges *ridges, uint32_t face);

/* ridge_face.c: computes the foci of a part whose pair has sources. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__ridge_foci(struct gd__ridges *ridges, uint32_t part,
                                          struct gd__focus focus[2]);

/* ridge_graph.c: gd__ridges_open allocates the arrays. gd__ridges_add appends a part with its ends
 * and, if it is bent, its arc; gd__ridges_bridge appends a straight part between two nodes;
 * gd__ridges_add_along appends a part along an edge. gd__ridges_settle gives nodes to the ends in a
 * face, and to the ends on an edge of the face if the edge's other face is done. gd__ridges_finish
 * adds the parts along edges and gives nodes to all other ends. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__ridges_open(struct gd__ridges *ridges);
void gd__ridges_close(struct gd__ridges *ridges);
GD_MUST_USE enum gd_status gd__ridges_add(struct gd__ridges *ridges, const struct gd__ridge *ridge,
                                          const struct gd__arc *arc);
GD_MUST_USE enum gd_status gd__ridges_bridge(struct gd__ridges *ridges,
                                             const struct gd__ridge *ridge);
GD_MUST_USE enum gd_status gd__ridges_add_along(struct gd__ridges *ridges, uint32_t edge,
                                                const struct gd__ridge *ridge);
GD_MUST_USE enum gd_status gd__ridges_settle(struct gd__ridges *ridges, uint32_t face);
GD_MUST_USE enum gd_status gd__ridges_finish(struct gd__ridges *ridges);

/* ridge_graph.c: counts the parts that end at each node. */
void gd__ridges_count(struct gd__ridges *ridges);

/* Returns true for a part whose ends are one node. Such a part is not longer than the rounding
 * error, or it was dropped. */
static inline bool gd__ridge_is_point(const struct gd__bisector_part *part)
{
    return part->node[0] == part->node[1];
}

/* Returns true if exactly one part ends at a node. Parts must have been counted. */
static inline bool gd__ridge_is_loose(const struct gd__node *node)
{
    return node->bisector_part[0] != GD_NONE && node->bisector_part[1] == GD_NONE;
}

/* ridge_gaps.c: joins loose ends to nodes close by, and removes copies of ridges along edges. Parts
 * must have been counted. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__ridges_close_gaps(struct gd__ridges *ridges);

/* ridge_branches.c: removes the branches of the graph (chains of parts) whose angles are below
 * `min_angle`, and joins the branches that they separated. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__ridges_keep_branches(struct gd__ridges *ridges);
