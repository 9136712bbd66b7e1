/* Voronoi diagram of a field: the nearest member for each point of the surface (distances include
 * offsets), and the bisectors between members.
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
 * (between a point and a segment). Seeds of one member have no bisector. Bisectors are not sampled:
 * on crossed edges and where three cells meet, the distances are equal up to rounding.
 *
 * Ties: members may be equally near in a region with area (behind a saddle or a boundary corner
 * that is equally far from both, behind a common point, or because the members coincide). Then one
 * member, chosen deterministically, owns the region. A member that is nowhere strictly nearest has
 * no label and no bisector. Along the border of such a region a bisector may oscillate by 1e-6 of
 * the field's greatest distance. */
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
    struct gd_bisector *bisectors; /* ordered by members */
    struct gd_point *points;
    size_t bytes; /* bytes of these arrays */
};

/* Writes the nearest member of every vertex index of the input to `out`, as gd_field_nearest; `out`
 * has index_count entries. UINT32_MAX means that a vertex that is not reached, is beyond a partial
 * field's reach, or is unreferenced. `member_of_seed` is a number for each seed, borrowed, or NULL.
 * If seeds of several members lie at the same point, the point belongs to the member with the least
 * offset. In a tie it belongs to the member with the most segments at the point, and in a further
 * tie to the first of these members. Errors, with `out` untouched: GD_INVALID_ARGUMENT (a member's
 * number), GD_NO_MEMORY, GD_INTERNAL (the field's predecessors lead to no seed). O(vertices + s log
 * s) for s seeds. Thread-safe. */
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
