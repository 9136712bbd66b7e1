/* Voronoi diagram of a field: the nearest member for each point of the surface, and the bisectors
 * between members. Distances include offsets.
 *
 *     struct gd_voronoi voronoi;
 *     if (gd_voronoi_trace(field, NULL, 1e-3, NULL, &voronoi) == GD_OK) {
 *         for (uint32_t i = 0; i < voronoi.bisector_count; i++)
 *             printf("%.17g\n", voronoi.bisectors[i].length);
 *         gd_voronoi_free(&voronoi);
 *     }
 *
 * A member is one or several of the field's seeds: a point, a curve, a boundary. Its number is
 * below gd_field_seed_count. If `member_of_seed` is NULL, each seed is a member with its own
 * number. Otherwise seed s belongs to `member_of_seed[s]`; some numbers may be unused. In a face
 * the distance is the minimum of the distances from several unfolded sources. Therefore a bisector
 * of two members is a chain of straight pieces, hyperbolas (between two points) and parabolas
 * (between a point and a segment). Two seeds of the same member have no bisector. Bisectors are not
 * sampled. On the edges that they cross and where three cells meet, the distances from the members
 * are equal up to rounding.
 *
 * Ties: members may be equally near in a whole region. This happens behind a saddle or a boundary
 * corner that is equally far from both members, behind a point that belongs to both members, or if
 * the members coincide. One of the members then owns the region; this selection is deterministic.
 * If a member is nowhere strictly nearest, it has no label and no bisector. Along the border of
 * such a region a bisector may oscillate by 1e-6 of the field's greatest distance. */
#ifndef GD_VORONOI_H
#define GD_VORONOI_H

#include "gd/field.h"

GD_EXTERN_C_BEGIN

/* A line of points that are equally near to two members, and not nearer to a third. The line is
 * closed, or ends at triple points or on the boundary. */
struct gd_bisector {
    uint32_t members[2]; /* members[0] < members[1] */
    bool closed;
    double length;        /* length of the polyline */
    uint32_t point_count; /* at least 2; a closed line repeats its first point at the end */
    /* Consecutive points lie in one face; both members are equally near to each point, to 1e-9 of
       the greatest distance. */
    const struct gd_point *points;
};

/* Owns all arrays. */
struct gd_voronoi {
    uint32_t bisector_count;
    struct gd_bisector *bisectors; /* ordered by their members */
    struct gd_point *points;
    size_t bytes; /* bytes of these arrays */
};

/* Writes the nearest member of every vertex index of the input, as gd_field_nearest, to `out`,
 * which has index_count entries. The entry is UINT32_MAX if the vertex has no path from a seed, is
 * beyond the reach of a partial field, or is unreferenced. `member_of_seed` has the member of each
 * seed; it is borrowed and may be NULL. If seeds of several members lie at the same point, the
 * point belongs to the member with the smallest offset. In a tie, it belongs to the member that has
 * most segments at the point, and in a further tie to the first of these members. Errors, with
 * `out` untouched: GD_INVALID_ARGUMENT (a member's number), GD_NO_MEMORY, GD_INTERNAL (the field's
 * predecessors lead to no seed). O(vertices + s log s) for s seeds. Thread-safe. */
GD_MUST_USE enum gd_status gd_voronoi_labels(const struct gd_field *field,
                                             const uint32_t *member_of_seed, uint32_t *out);

/* Traces all bisectors, as polylines within `tolerance` > 0 (a length) of the exact bisectors.
 * `member_of_seed`: as in gd_voronoi_labels; `control` may be NULL. The caller frees `*out` by
 * gd_voronoi_free. Errors: GD_INVALID_ARGUMENT (the tolerance, a member's number), GD_BEYOND_REACH
 * (a partial field), GD_INTERNAL (as in gd_voronoi_labels), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Cost: a pass over the wedges, and O(k^2) to O(k^3) for each face with more than one
 * nearest member, where k is the number of wedges of the face's edges. Thread-safe. */
GD_MUST_USE enum gd_status gd_voronoi_trace(const struct gd_field *field,
                                            const uint32_t *member_of_seed, double tolerance,
                                            const struct gd_control *control,
                                            struct gd_voronoi *out);

/* Frees the arrays and zeroes the struct. NULL is allowed. */
void gd_voronoi_free(struct gd_voronoi *voronoi);

GD_EXTERN_C_END

#endif
