/* A Voronoi diagram from the inside: a graph of strands, each the bisector of two sources in one
 * face, between nodes.
 *
 * DESIGN
 * - Members are told apart where they tie by a nudge: each one's distance is taken to be longer by
 *   a tiny amount of its own (GD_TOL_TIE). So the diagram is in general position, whatever the
 *   symmetries of surface and seeds are, and edges and faces decide alike. The nudge says what
 *   meets what; where that is, is found without it.
 * - Vertices get an owner. Along an edge the owners are those of the lower envelope of its windows;
 *   where they change is a switch, a node that both faces of the edge share. An edge's first and
 *   last owner may differ from its end's: then the switch is at that end.
 * - In a face, each two sources of different members give strands: the parts of their branch
 *   (voronoi_branch.h) which both see and where no third source is nearer. Their ends are matched
 *   by place: with a switch, with the end of a strand of the same members, or two others at a
 *   triple point.
 * - Bisectors are the chains of strands through nodes at which two of them meet.
 * - Inside unit. */
#ifndef GD_FIELD_VORONOI_PARTS_H
#define GD_FIELD_VORONOI_PARTS_H

#include "field/voronoi_branch.h"
#include "gd/voronoi.h"
#include "window/stack.h"

/* Whose a pseudo-source is, and how much farther a member is taken to be. */
struct gd__members {
    uint32_t *of; /* vertex_count + seed_count; GD_NONE: no path reaches it */
    /* per member, of which there may be as many as seeds; below GD_TOL_TIE of `farthest` */
    double *nudge;
    double farthest; /* no point of an edge is farther */
};

static inline uint32_t gd__member_of(const struct gd__members *members, uint32_t source)
{
    return members->of[source & ~GD__SOURCE_LINEAR];
}

/* voronoi_members.c: `member_of_seed` as for gd_voronoi_trace. GD_INVALID_ARGUMENT, GD_NO_MEMORY,
 * GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__members_find(const struct gd_field *field,
                                            const uint32_t *member_of_seed,
                                            struct gd__members *out);

/* Gives points that lie on another member's segment, and so own nothing, to that member: else the
 * nudge might give them something. GD_INTERNAL, GD_CANCELLED, GD_DEADLINE. O(k^2) for each face
 * with k seeds. */
GD_MUST_USE enum gd_status gd__members_settle(const struct gd_field *field,
                                              const struct gd_control *control,
                                              struct gd__members *members);

/* Takes over owners of vertices that differ, for these and for all whose way leads through them.
 * GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__members_change(const struct gd_field *field, const uint32_t *owner,
                                              struct gd__members *members);
void gd__members_destroy(struct gd__members *members);

/* Ends of linear wedges are stored rounded inwards, to 2^-32 of an edge no longer than `size`: a
 * line is taken to see that much more, lest there be gaps between neighbours. `away`: how far that
 * end lies from the segment. */
static inline double gd__line_lengthened(double size, double away)
{
    return fmax(fmin(2 * GD__WEDGE_UNIT * size, GD_TOL_LENGTHENED * away), 0);
}

struct gd__node {
    struct gd_point point;
    uint32_t strand[2]; /* that meet there; GD_NONE: there is none */
    bool is_end;        /* bisectors end here */
};

/* Where the owner changes along an edge; t: from the origin of side 0, in [0, length]. */
struct gd__switch {
    uint32_t node;
    double t;
    uint32_t before, after; /* members */
};

struct gd__strand {
    uint32_t face;
    uint32_t member[2]; /* ascending */
    uint32_t node[2];
    struct gd__focus focus[2];
    double from, to;  /* angles of its branch as seen from focus[0] */
    bool is_straight; /* a line between two segments, or no branch: it bridges rounding, or a tie */
};

/* What has been found. Switches of edge e: first_switch[e] to first_switch[e + 1]. All zero is
 * empty. */
struct gd__diagram {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    const uint32_t *member_of_seed; /* NULL: each is one */
    struct gd__members members;
    /* per vertex: members.of, and who else has a better claim where there is a tie */
    uint32_t *owner;
    double *nearest;        /* per vertex: its owner's nudged distance; 0: nobody else gets it */
    uint32_t changed;       /* owners that differ */
    uint32_t *first_switch; /* per edge, and one more */
    struct gd__node *node;
    struct gd__switch *edge_switch;
    struct gd__strand *strand;
    uint32_t node_count, node_capacity, switch_count, switch_capacity, strand_count,
        strand_capacity;
};

/* The end of a strand in the face at hand, or a node that one is to end at: a switch, or a triple
 * point which lacks one. */
struct gd__loose {
    struct gd__local at;
    uint32_t member[2];   /* ascending */
    uint32_t third;       /* the source that takes over there; GD_NONE: none does */
    bool is_triple;       /* and it is of a third member */
    uint32_t strand, end; /* GD_NONE: a node's */
    uint32_t node;        /* GD_NONE: not yet */
    bool is_matched;      /* with another one */
};

/* Two of them that may be one, and their distance squared. */
struct gd__tie {
    double apart;
    uint32_t a, b;
};

/* What a source sees of a face: a triangle that up to three lines have cut. */
struct gd__view {
    int count;
    struct gd__local corner[7];
    double most; /* no place of it is farther, nudged */
};

/* Scratch of an edge and a face, reused; all zero is empty. */
struct gd__voronoi_scratch {
    struct gd__stack envelope, tail;
    struct gd__sources sources;
    struct gd__view *view; /* per source */
    struct gd__spans covered, spans;
    struct gd__loose *loose;
    struct gd__tie *tie;
    uint32_t view_capacity, loose_count, loose_capacity, tie_count, tie_capacity;
};

/* voronoi_edge.c: does an edge see more than one member? If so: gives its ends to whom its windows
 * are nearest there; */
bool gd__edge_is_mixed(const struct gd__diagram *diagram, uint32_t edge);
void gd__edge_own_ends(struct gd__diagram *diagram, uint32_t edge);

/* appends its switches, the vertices' owners being final. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__edge_switch(struct gd__diagram *diagram, uint32_t edge,
                                           struct gd__voronoi_scratch *scratch);

/* voronoi_face.c: appends the strands of a face, the switches of whose edges are there, with their
 * loose ends; voronoi_match.c: gives those their nodes. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__face_strands(struct gd__diagram *diagram, uint32_t face,
                                            struct gd__voronoi_scratch *scratch);
GD_MUST_USE enum gd_status gd__loose_append(struct gd__voronoi_scratch *scratch,
                                            struct gd__loose loose);
GD_MUST_USE enum gd_status gd__face_match(struct gd__diagram *diagram,
                                          struct gd__voronoi_scratch *scratch);

/* How to export. */
struct gd__export {
    double tolerance; /* inside unit */
    const struct gd_control *control;
    size_t held;  /* bytes, by the diagram */
    double begun; /* the part of the work that is done */
};

/* voronoi_line.c: the chains of strands as polylines. GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__diagram_export(struct gd__diagram *diagram,
                                              const struct gd__export *how, struct gd_voronoi *out);

/* voronoi.c: appends a node or a strand, *out: its number. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__diagram_add_node(struct gd__diagram *diagram,
                                                const struct gd_point *point, uint32_t *out);
GD_MUST_USE enum gd_status gd__diagram_add_strand(struct gd__diagram *diagram,
                                                  const struct gd__strand *strand, uint32_t *out);

#endif
