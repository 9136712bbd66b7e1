/* A Voronoi diagram under construction: a graph of nodes and parts of bisectors. Each part is the
 * bisector of two sources in one face.
 *
 * DESIGN
 * - A nudge separates members that tie: each member's distance is increased by a tiny amount of its
 *   own (GD_TOL_TIE). With nudges the diagram is in general position even if surface and seeds are
 *   symmetric, and edges and faces decide ties consistently. Nudges determine the topology only;
 *   positions are computed without them.
 * - Each vertex has an owner: the member with the least distance. Along an edge the owners come
 *   from the lower envelope of the edge's windows. An owner change is a node where the owner
 *   changes; both faces of the edge share it. If the first or last owner along an edge differs from
 *   the owner of the edge's end, the owner change is at that end.
 * - In a face, any two sources of different members have a branch (voronoi_branch.h). The parts of
 *   bisectors are the parts of branches that both sources see and to which no third source is
 *   nearer. Each end of a part is matched by position: with an owner change, with an end of another
 *   part of the same two members, or, at a triple point, with the ends of two other parts.
 * - A bisector is a chain of parts, joined at nodes where two parts meet.
 * - Normalised unit. */
#pragma once

#include "base/arena.h"
#include "base/prefetch.h"
#include "base/pace.h"
#include "field/source_view.h"
#include "gd/voronoi.h"
#include "window/stack.h"

/* The member of each pseudo-source, and the nudge of each member. */
struct gd__members {
    uint32_t *of; /* vertex_count + seed_count; GD_NONE if unreached */
    /* for each member (at most seed_count), less than GD_TOL_TIE * farthest */
    double *nudge;
    double farthest; /* upper bound of the distances on edges */
};

static inline uint32_t gd__member_of(const struct gd__members *members, uint32_t source)
{
    return members->of[source & ~GD__SOURCE_LINEAR];
}

/* voronoi_members.c: finds the members and nudges. `member_of_seed` is that of gd_voronoi_trace.
 * Errors: GD_INVALID_ARGUMENT, GD_NO_MEMORY, GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__members_find(const struct gd_field *field,
                                            const uint32_t *member_of_seed, struct gd__arena *arena,
                                            struct gd__members *out);

/* Assigns a point seed that lies on another member's segment to that member. Such a point is
 * nowhere strictly nearest, but the nudge might give it a region. Errors: GD_INTERNAL,
 * GD_CANCELLED, GD_DEADLINE. O(k^2) for each face with k seeds. */
GD_MUST_USE enum gd_status gd__members_settle(const struct gd_field *field,
                                              const struct gd_control *control,
                                              struct gd__members *members);

/* Sets the members of vertices whose owners changed, and of all vertices whose paths pass them.
 * Error: GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__members_change(const struct gd_field *field, const uint32_t *owner,
                                              struct gd__members *members);

struct gd__node {
    struct gd_point point;
    uint32_t bisector_part[2]; /* parts that meet at the node, or GD_NONE if there is none */
    bool is_end;               /* bisectors end at the node */
};

/* An owner change along an edge; t is measured from the origin of side 0, in [0, length]. */
struct gd__owner_change {
    uint32_t node;
    double t;
    uint32_t before, after; /* members */
};

struct gd__bisector_part {
    uint32_t face;
    uint32_t member[2]; /* ascending */
    uint32_t node[2];
    uint32_t arc; /* number of its arc; GD_NONE means a straight line between its nodes */
};

/* A piece of the branch of two sources. It is straight if both are linear. */
struct gd__arc {
    struct gd__focus focus[2];
    double from, to; /* angles about focus[0] */
};

/* MIXED: the windows of an edge belong to more than one member. */
enum gd__mixture { GD__MIXTURE_UNKNOWN, GD__MIXTURE_PURE, GD__MIXTURE_MIXED };

/* The diagram under construction. Edge e has the owner changes first_switch[e] to first_switch[e +
 * 1] - 1. An all-zero struct is empty. */
struct gd__diagram {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    const uint32_t *member_of_seed; /* NULL means that each seed is a member */
    struct gd__arena arena;         /* those of this struct */
    struct gd__members members;
    /* for each vertex, members.of, or the member that wins a tie */
    uint32_t *owner;
    /* for each vertex, its nudged distance from its owner; 0 if uncontested */
    double *nearest;
    uint32_t changed;       /* number of owners that differ from members.of */
    uint8_t *mixture;       /* for each edge, an enum gd__mixture */
    uint32_t *first_switch; /* for each edge; one more entry at the end */
    struct gd__node *node;
    struct gd__owner_change *edge_switch;
    struct gd__bisector_part *bisector_part;
    struct gd__arc *arc;
    uint32_t node_count, node_capacity, switch_count, switch_capacity, bisector_part_count,
        bisector_part_capacity, arc_count, arc_capacity;
};

/* The end of a part in the current face, or a node where a part must end. Such a node is an owner
 * change, or a triple point with a missing part. */
struct gd__loose_end {
    struct gd__local at;
    uint32_t member[2]; /* ascending */
    /* the third source, which becomes nearer beyond the end, or GD_NONE if there is none */
    uint32_t third;
    bool is_triple;              /* the third source belongs to a third member */
    uint32_t bisector_part, end; /* GD_NONE means a node */
    uint32_t node;               /* GD_NONE if there is no node yet */
    bool is_matched;             /* matched with another end */
};

/* Two ends that may match, and their distance squared. */
struct gd__close_pair {
    double apart;
    uint32_t a, b;
};

/* Reused scratch for an edge and a face. An all-zero struct is empty. */
struct gd__voronoi_scratch {
    struct gd__stack envelope, tail;
    struct gd__sources sources;
    struct gd__view *view; /* per source */
    struct gd__loose_end *loose;
    struct gd__close_pair *tie;
    uint32_t view_capacity, loose_count, loose_capacity, tie_count, tie_capacity;
    struct gd__pace pace; /* of the work in a face */
};

/* voronoi_edge.c: gd__edge_is_mixed returns true if the windows of an edge and its ends belong to
 * more than one member. gd__edge_own_ends sets the owners of such an edge's ends from the nearest
 * windows. */
bool gd__edge_is_mixed(const struct gd__diagram *diagram, uint32_t edge);

/* Prefetches the windows that gd__edge_is_mixed reads some edges later. */
GD__PREFETCH gd__edge_prefetch(const struct gd__diagram *diagram, uint32_t edge)
{
    const uint32_t ahead = 32; /* edges */
    if (diagram->mesh->edge_count - edge <= ahead) return;
    uint32_t at = diagram->field->newest[edge + ahead];
    if (at == GD_NONE) return;
    __builtin_prefetch(gd__field_chunk(diagram->field, at));
    __builtin_prefetch((const char *)gd__field_chunk(diagram->field, at) + 64);
}

void gd__edge_own_ends(struct gd__diagram *diagram, uint32_t edge);

/* Appends the owner changes of an edge. The owners of vertices must be final. Error:
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__edge_owner_change(struct gd__diagram *diagram, uint32_t edge,
                                                 struct gd__voronoi_scratch *scratch);

/* voronoi_face.c: gd__face_bisector_parts appends the parts of a face, and collects their loose
 * ends in `scratch`; the owner changes of the face's edges must exist. gd__loose_end_append appends
 * a loose end. voronoi_match.c: gd__face_match assigns nodes to the loose ends. Errors:
 * GD_NO_MEMORY, and those of the pace. */
GD_MUST_USE enum gd_status gd__face_bisector_parts(struct gd__diagram *diagram, uint32_t face,
                                                   struct gd__voronoi_scratch *scratch);
GD_MUST_USE enum gd_status gd__loose_end_append(struct gd__voronoi_scratch *scratch,
                                                struct gd__loose_end loose);
GD_MUST_USE enum gd_status gd__face_match(struct gd__diagram *diagram,
                                          struct gd__voronoi_scratch *scratch);

/* Options of gd__diagram_export. */
struct gd__export_options {
    double tolerance; /* normalised unit */
    const struct gd_control *control;
    double progress; /* progress of the call */
};

/* voronoi_line.c: converts the chains of parts to polylines. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__diagram_export(struct gd__diagram *diagram,
                                              const struct gd__export_options *how,
                                              struct gd_voronoi *out);

/* voronoi.c: append a node, a part or an arc, and set *out to its number. Errors: GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__diagram_add_node(struct gd__diagram *diagram,
                                                const struct gd_point *point, uint32_t *out);
GD_MUST_USE enum gd_status
gd__diagram_add_bisector_part(struct gd__diagram *diagram,
                              const struct gd__bisector_part *bisector_part, uint32_t *out);
GD_MUST_USE enum gd_status gd__diagram_add_arc(struct gd__diagram *diagram,
                                               const struct gd__arc *arc, uint32_t *out);

/* Adds a part to the node of one of its ends. If two parts meet at the node already, bisectors end
 * there. */
void gd__diagram_count_end(struct gd__diagram *diagram, uint32_t part, uint32_t end);
