/* Voronoi diagram: which member of a field each part of the surface is nearest to, offsets
 * included, and the lines between them.
 *
 *     struct gd_voronoi voronoi;
 *     if (gd_voronoi_trace(field, NULL, 1e-3, NULL, &voronoi) == GD_OK) {
 *         for (uint32_t i = 0; i < voronoi.bisector_count; i++)
 *             printf("%.17g\n", voronoi.bisectors[i].length);
 *         gd_voronoi_free(&voronoi);
 *     }
 *
 * A member is one or several of the field's seeds, points and segments: a point, a curve, a
 * boundary. It goes by a number below gd_field_seed_count: that of the seed where each seed is one
 * (`member_of_seed` is NULL), else `member_of_seed[seed]`, and not every number need be in use. In
 * a face the distance is the least of those from several unfolded sources, so that a bisector of
 * two members is a chain of straight pieces and pieces of hyperbolas (between two points) and
 * parabolas (between a point and a segment), each between two such sources; between seeds of one
 * member there is none. Nothing here is sampled: edges are crossed, and three cells meet, where the
 * distances are equal up to rounding.
 *
 * Ties. Where members are equally near on more than a line (behind a saddle or a corner of the
 * boundary that is as far from both, or behind a point that both have, or because they coincide)
 * one of them, always the same, has it all. A member that is nowhere strictly nearest owns nothing:
 * no label, no bisector. Along the edge of such a region a bisector may run to and fro by 1e-6 of
 * the field's greatest distance. */
#ifndef GD_VORONOI_H
#define GD_VORONOI_H

#include "gd/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A line that two members are equally near to, and no other is nearer: closed, or with ends that
 * are triple points or lie on the boundary. */
struct gd_bisector {
    uint32_t members[2]; /* members[0] < members[1] */
    bool closed;
    double length;        /* of the polyline */
    uint32_t point_count; /* at least 2; a closed one ends in its first point */
    /* Consecutive ones within one face; both members are as near to each of them, to 1e-9 of the
     * greatest distance. */
    const struct gd_point *points;
};

/* Owns all arrays. */
struct gd_voronoi {
    uint32_t bisector_count;
    struct gd_bisector *bisectors; /* by members */
    struct gd_point *points;
    size_t bytes; /* that these arrays take */
};

/* The nearest member at every vertex index of the input (`out`: index_count of them), that of
 * gd_field_nearest; UINT32_MAX for vertices that no path reaches, that are beyond a partial field's
 * reach, or unreferenced. `member_of_seed`: a number for each seed, borrowed, or NULL. Of members
 * with seeds at one place the one with the least offset, then with the most segments there, then
 * the first, has it. Errors: GD_INVALID_ARGUMENT (a member's number), GD_NO_MEMORY, GD_INTERNAL
 * (the ways that the field keeps lead to no seed); `out` is untouched then. O(vertices + s log s)
 * for s seeds. Thread-safe. */
GD_MUST_USE enum gd_status gd_voronoi_labels(const struct gd_field *field,
                                             const uint32_t *member_of_seed, uint32_t *out);

/* Traces all bisectors, as polylines that are nowhere farther than `tolerance` > 0 (a length) from
 * them. `member_of_seed` as above, `control` may be NULL. The caller frees `*out` by
 * gd_voronoi_free. Errors: GD_INVALID_ARGUMENT (the tolerance, a member's number), GD_BEYOND_REACH
 * (a partial field does not know), GD_INTERNAL as above, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Cost: a pass over the wedges, and O(k^2) to O(k^3) for each face that sees more than
 * one member, of k wedges around it. Thread-safe. */
GD_MUST_USE enum gd_status gd_voronoi_trace(const struct gd_field *field,
                                            const uint32_t *member_of_seed, double tolerance,
                                            const struct gd_control *control,
                                            struct gd_voronoi *out);

/* frees the arrays and zeroes; NULL is harmless */
void gd_voronoi_free(struct gd_voronoi *voronoi);

#ifdef __cplusplus
}
#endif

#endif
