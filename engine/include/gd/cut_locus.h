/* Cut locus of a field: the points that several shortest paths reach from different directions. The
 * cut locus of a point is the set where shortest paths from the point stop being shortest. The cut
 * locus of a curve is its medial axis: the bisectors between the parts of the curve. The cut locus
 * of several members contains their Voronoi diagram (gd/voronoi.h).
 *
 *     struct gd_voronoi ridges;
 *     if (gd_cut_locus_trace(field, NULL, &(struct gd_cut_locus_options){.tolerance = 1e-3}, NULL,
 *                            &ridges) == GD_OK) {
 *         for (uint32_t i = 0; i < ridges.bisector_count; i++)
 *             printf("%.17g\n", ridges.bisectors[i].length);
 *         gd_voronoi_free(&ridges);
 *     }
 *
 * The cut locus is a graph of *ridges* of the distance. In a face, a ridge is a piece of a line, a
 * hyperbola or a parabola, as in a Voronoi diagram. A ridge ends where it meets two other ridges,
 * on the boundary, at a joint of a curve (a point where two segments of its polyline meet), or at a
 * vertex with a total angle below 2 pi. Each such vertex is the end of a ridge. Behind a vertex
 * where paths bend, all paths arrive from this vertex, so there is no ridge, even if the vertex
 * itself has several shortest paths.
 *
 * The angle of a ridge at a point is the angle between the two directions of arrival. A ridge that
 * begins at a joint of a curve has the angle by which the curve turns there. A ridge that begins at
 * a vertex has the angle deficit of the vertex: 2 pi minus its total angle. So `min_angle` removes
 * ridges that exist only because a polyline or a mesh approximates a smooth shape. */
#ifndef GD_CUT_LOCUS_H
#define GD_CUT_LOCUS_H

#include "gd/voronoi.h"

GD_EXTERN_C_BEGIN

/* Two paths count as one path if their directions of arrival differ by less than this angle. */
#define GD_CUT_LOCUS_ANGLE 1e-3

struct gd_cut_locus_options {
    /* largest distance of the polylines from the ridges; more than 0 */
    double tolerance;
    /* A branch of the graph (from one end or meeting point to the next) is omitted if its angle is
       below `min_angle` at all of its points. If `min_angle` is below GD_CUT_LOCUS_ANGLE, for
       example 0, GD_CUT_LOCUS_ANGLE is used instead. `min_angle` is at most pi. */
    double min_angle;
};

/* Traces all ridges. `member_of_seed` is as in gd_voronoi_labels and only names the ridges: the
 * members of a ridge are those of its two paths, and may be equal. `control` may be NULL. The
 * caller frees `*out` by gd_voronoi_free. Each point of a ridge's polyline has two paths whose
 * lengths differ by at most 1e-9 of the greatest distance. Errors: GD_INVALID_ARGUMENT (an option,
 * a member's number), GD_BEYOND_REACH (a partial field), GD_INTERNAL (as in gd_voronoi_labels),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Time: O(k^2) for each face with k sources
 * (wedges of its edges), and O(k) for each pair of sources that competes for a part of the face.
 * Memory: about 100 to 200 bytes for each ridge in a face; there are at most about as many such
 * ridges as wedges. Thread-safe. */
GD_MUST_USE enum gd_status gd_cut_locus_trace(const struct gd_field *field,
                                              const uint32_t *member_of_seed,
                                              const struct gd_cut_locus_options *options,
                                              const struct gd_control *control,
                                              struct gd_voronoi *out);

GD_EXTERN_C_END

#endif
